#include "base/stopwatch.h"
#include "net/net_fixture.h"

namespace surfcast::net {
namespace {

class ShutdownTest : public NetFixture {
 protected:
  /// Begins to stop the server, and returns once it sends idle clients away.
  void stop_taking_connections() {
    RawSocket idle(port_);
    server_->stop();
    EXPECT_TRUE(idle.closed_within(milliseconds(9000))) << "before the time for first words ends it";
  }
};

TEST_F(ShutdownTest, APictureThatIsBeingDrawnIsFinishedAndDelivered) {
  control_->slow = true;
  start();
  auto connection = connect();
  ASSERT_TRUE(connection);
  ASSERT_TRUE(connection->send(picture_request("cube")));
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1; }));
  stop_taking_connections();
  control_->slow = false;
  const auto answer = connection->receive();
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->has_picture());
  stop();
}

TEST_F(ShutdownTest, APictureOfHttpIsFinishedAndDelivered) {
  control_->slow = true;
  start();
  RawSocket socket(port_);
  socket.send("GET /api/models/cube/image?resolution=4,4 HTTP/1.1\r\nHost: here\r\n\r\n");
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1; }));
  stop_taking_connections();
  control_->slow = false;
  EXPECT_NE(socket.read_to_end().find("PNG"), std::string::npos);
  stop();
}

TEST_F(ShutdownTest, APictureThatTakesTooLongIsCancelled) {
  control_->slow = true;
  ServerConfig config;
  config.drain = milliseconds(100);
  start(config);
  auto connection = connect();
  ASSERT_TRUE(connection);
  ASSERT_TRUE(connection->send(picture_request("cube")));
  RawSocket http(port_);
  http.send("GET /api/models/cube/image HTTP/1.1\r\nHost: here\r\n\r\n");
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1 && service_->queued() == 1; }));
  const Stopwatch watch;
  stop();
  EXPECT_LT(watch.seconds(), 60) << "by themselves the pictures never end";
  EXPECT_GE(control_->cancelled, 1);
  EXPECT_EQ(control_->cancelled, control_->drawn);  // the second picture may have begun, too; none is finished
  EXPECT_FALSE(connection->receive());
}

TEST_F(ShutdownTest, APictureOfHttpThatTakesTooLongIsAnsweredWithAnError) {
  control_->slow = true;
  ServerConfig config;
  config.drain = milliseconds(1000);  // also the time for the answer, which is a second at most
  start(config);
  RawSocket socket(port_);
  socket.send(std::string_view("GET /api/models/cube/image HTTP/1.1\r\nHost: here\r\n\r\n"));
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1; }));
  server_->stop();
  const std::string answer = socket.read_to_end();
  EXPECT_EQ(answer.substr(9, 3), "503");
  EXPECT_NE(answer.find("Retry-After"), std::string::npos);
  stop();
}

TEST_F(ShutdownTest, ReadinessEndsBeforeAnythingElse) {
  ServerConfig config;
  config.grace = milliseconds(60'000);
  start(config);
  EXPECT_EQ(get("/readyz").substr(9, 3), "200");
  server_->stop();
  EXPECT_TRUE(eventually([&] { return get("/readyz").substr(9, 3) == "503"; }));
  EXPECT_EQ(get("/healthz").substr(9, 3), "200");
  EXPECT_EQ(get("/api/models/cube/image?resolution=4,4").substr(9, 3), "200") << "who has not seen it yet is served";
  auto connection = connect();
  ASSERT_TRUE(connection);
  EXPECT_TRUE(connection->ask(picture_request("cube")));
  stop();  // the second time it ends at once
}

TEST_F(ShutdownTest, IdleConnectionsDoNotDelayTheEnd) {
  ServerConfig config;
  config.drain = milliseconds(60'000);
  start(config);
  auto connection = connect();
  ASSERT_TRUE(connection);
  ASSERT_TRUE(connection->ask(ping_request()));
  RawSocket silent(port_);
  RawSocket http(port_);
  http.send("GET /healthz HTTP/1.1\r\nHost: here\r\n\r\n");
  http.read_http();
  const Stopwatch watch;
  stop();
  EXPECT_LT(watch.seconds(), 30) << "half of what a server takes that waits for them";
}

TEST_F(ShutdownTest, APortInUseIsAnErrorThatNamesIt) {
  start();
  ServerConfig config;
  config.port = port_;
  const auto second = Server::create(*service_, config);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find(std::to_string(port_)), std::string::npos);
}

}  // namespace
}  // namespace surfcast::net
