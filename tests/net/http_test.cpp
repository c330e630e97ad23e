#include <nlohmann/json.hpp>
#include <vector>

#include "net/net_fixture.h"

namespace surfcast::net {
namespace {

using nlohmann::json;

class HttpSessionTest : public NetFixture {};

std::string body_of(const std::string& answer) {
  return answer.substr(answer.find("\r\n\r\n") + 4);
}

std::string status_of(const std::string& answer) {
  return answer.substr(9, 3);
}

TEST_F(HttpSessionTest, ModelsAreAList) {
  start();
  const std::string answer = get("/api/models");
  EXPECT_EQ(status_of(answer), "200");
  EXPECT_EQ(json::parse(body_of(answer))["models"], json({"cube", "teapot"}));
}

TEST_F(HttpSessionTest, AModelIsDescribed) {
  start();
  const json model = json::parse(body_of(get("/api/models/teapot")));
  EXPECT_EQ(model["surfels"], 1234);
  EXPECT_EQ(model["up_axis"], "y");
  EXPECT_EQ(model["bounds"]["min"], json({-1.0, -2.0, -3.0}));
  EXPECT_EQ(model["spacing"], 0.25);
  EXPECT_EQ(model["ranges"][0]["attribute"], "intensity");
  EXPECT_EQ(model["ranges"][0]["high"], 8);
  EXPECT_EQ(model["classes"][1]["surfels"], 34);
}

TEST_F(HttpSessionTest, PicksNeedAPixelAndAModel) {
  start();
  for (const std::string query : {"", "pixel=3", "pixel=3,4,5", "pixel=-1,2", "pixel=1,2&pixel=1,2", "pixel=1,2&a=b",
                                  "pixel=1,2&color_range=2,1", "pixel=1,2&clip_box=0,0,0,nan,1,1"}) {
    EXPECT_EQ(status_of(get("/api/models/cube/pick?" + query)), "400") << query;
  }
  EXPECT_EQ(status_of(get("/api/models/cube/pick?pixel=9999,2")), "400") << "outside the picture";
  EXPECT_EQ(status_of(get("/api/models/cube/pick?pixel=1,2&resolution=8,8&hide_classes=2")), "404");
}

TEST_F(HttpSessionTest, AnImageHasItsTypeAndItsFigures) {
  start();
  const std::string answer = get("/api/models/cube/image?resolution=20,10&format=jpg&background=1,2,3");
  EXPECT_EQ(status_of(answer), "200");
  EXPECT_NE(answer.find("Content-Type: image/jpeg\r\n"), std::string::npos);
  EXPECT_NE(answer.find("X-Surfcast-Surfels: 99\r\n"), std::string::npos);
  EXPECT_NE(answer.find("Server-Timing: queue;dur="), std::string::npos);
  EXPECT_EQ(body_of(answer).substr(0, 3), "\xff\xd8\xff");
}

TEST_F(HttpSessionTest, EscapedCommasOfAQueryAreCommas) {
  start();
  const std::string answer =
      get("/api/models/cube/image?resolution=20%2C10&position=1%2C-2%2c3e0&focal_point=0,0,0&view_angle=45");
  EXPECT_EQ(status_of(answer), "200");
  EXPECT_NE(answer.find("\"position\":[1.0,-2.0,3.0]"), std::string::npos);
}

TEST_F(HttpSessionTest, WrongQueriesAreExplained) {
  start();
  for (const std::string query :
       {"resolution=20", "resolution=20,10,5", "resolution=20x10", "resolution=-1,5", "resolution=9000,1",
        "view_angle=nan", "position=1,2,3", "colour=red", "format=gif", "quality=0", "spacing=1;drop",
        "background=256,0,0", "channels=depth", "format=exr&channels=colour", "position=1,2,3&position=1,2,3",
        "position=%zz", "resolution=%00"}) {
    const std::string answer = get("/api/models/cube/image?" + query);
    EXPECT_EQ(status_of(answer), "400") << query;
    EXPECT_FALSE(json::parse(body_of(answer))["error"]["message"].get<std::string>().empty()) << query;
  }
}

TEST_F(HttpSessionTest, PlacesThatDoNotExistAre404) {
  start();
  for (const std::string target : {"/nothing", "/api", "/api/models/", "/api/models/absent", "/api/models/absent/image",
                                   "/api/models/cube/picture", "/api/models//image", "/../etc/passwd",
                                   "/api/models/..%2f..%2fetc%2fpasswd", "/api/models/..%2f..%2fetc%2fpasswd/image"}) {
    const std::string answer = get(target);
    EXPECT_EQ(status_of(answer), "404") << target;
    EXPECT_EQ(json::parse(body_of(answer))["error"]["kind"], "not_found");
  }
}

TEST_F(HttpSessionTest, OtherMethodsAre405) {
  start();
  for (const std::string method : {"DELETE", "PUT", "OPTIONS", "PATCH"}) {
    const std::string answer = http(method + " /api/models HTTP/1.1\r\nHost: here\r\n\r\n");
    EXPECT_EQ(status_of(answer), "405") << method;
    EXPECT_NE(answer.find("Allow: GET, HEAD"), std::string::npos);
  }
}

TEST_F(HttpSessionTest, HeadHasTheHeaderOfGetAndNoBody) {
  start();
  RawSocket socket(port_);
  socket.send("HEAD /api/models HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
  const std::string answer = socket.read_to_end();
  EXPECT_EQ(status_of(answer), "200");
  EXPECT_EQ(body_of(answer), "");
  EXPECT_EQ(answer.find("Content-Length: 0"), std::string::npos);
}

TEST_F(HttpSessionTest, OneConnectionServesManyRequestsAlsoPipelined) {
  start();
  RawSocket socket(port_);
  const std::string request = "GET /healthz HTTP/1.1\r\nHost: here\r\n\r\n";
  socket.send(request);
  EXPECT_EQ(body_of(socket.read_http()), "ok\n");
  const std::string picture = "GET /api/models/cube/image?resolution=4,4 HTTP/1.1\r\nHost: here\r\n\r\n";
  socket.send(picture + request + picture);
  EXPECT_EQ(body_of(socket.read_http()).substr(1, 3), "PNG");
  EXPECT_EQ(body_of(socket.read_http()), "ok\n");
  EXPECT_EQ(body_of(socket.read_http()).substr(1, 3), "PNG");
}

TEST_F(HttpSessionTest, MalformedRequestsAre400AndCloseTheConnection) {
  start();
  for (const std::string request :
       {"nonsense\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n",
        "GET / HTTP/1.1\r\nContent-Length: many\r\n\r\n"}) {
    RawSocket socket(port_);
    socket.send(request);
    EXPECT_EQ(status_of(socket.read_to_end()), "400") << request;
  }
}

TEST_F(HttpSessionTest, AHeaderBeyondTheLimitIs431) {
  start();
  RawSocket socket(port_);
  socket.send("GET / HTTP/1.1\r\nX-Large: " + std::string(40'000, 'x') + "\r\n\r\n");
  EXPECT_EQ(status_of(socket.read_to_end()), "431");
}

TEST_F(HttpSessionTest, ABodyIsRefused) {
  start();
  RawSocket socket(port_);
  socket.send("POST /api/models HTTP/1.1\r\nHost: here\r\nContent-Length: 99999999999\r\n\r\n" + std::string(100, 'x'));
  EXPECT_EQ(status_of(socket.read_to_end()), "413");
}

TEST_F(HttpSessionTest, AClientThatVanishesHasItsPictureCancelled) {
  control_->slow = true;
  start();
  RawSocket socket(port_);
  socket.send("GET /api/models/cube/image HTTP/1.1\r\nHost: here\r\n\r\n");
  ASSERT_TRUE(eventually([&] { return control_->drawn == 1; }));
  socket.close();
  EXPECT_TRUE(eventually([&] { return control_->cancelled == 1; }));
}

TEST_F(HttpSessionTest, ARequestThatIsNeverFinishedIsClosed) {
  ServerConfig config;
  config.hello = milliseconds(150);
  start(config);
  RawSocket socket(port_);
  socket.send("GET / HTT");
  bool open = true;
  for (int i = 0; i < 500 && open; ++i) {
    std::this_thread::sleep_for(milliseconds(20));
    open = socket.send("x");
  }
  EXPECT_FALSE(open);
}

TEST_F(HttpSessionTest, MetricsCountWhatHappened) {
  start();
  ASSERT_EQ(status_of(get("/api/models/cube/image?resolution=4,4")), "200");
  ASSERT_EQ(status_of(get("/nothing")), "404");
  auto connection = connect();
  ASSERT_TRUE(connection);
  ASSERT_FALSE(connection->ask(picture_request("absent")));
  EXPECT_EQ(metric("surfcast_pictures_total"), 1);
  EXPECT_EQ(metric("surfcast_errors_total"), 2);
  EXPECT_EQ(metric("surfcast_surfels_drawn_total"), 99);
  EXPECT_GT(metric("surfcast_picture_bytes_total"), 50);
  EXPECT_NE(get("/metrics").find("surfcast_stage_seconds_total{stage=\"draw\"} 0.0015"), std::string::npos);
}

TEST_F(HttpSessionTest, WithoutAViewerTheRootSaysHowToGetOne) {
  start();
  const std::string answer = get("/");
  EXPECT_EQ(status_of(answer), "200");
  EXPECT_NE(answer.find("Content-Type: text/plain"), std::string::npos);
  EXPECT_NE(body_of(answer).find("--viewer DIR"), std::string::npos);
  EXPECT_NE(body_of(answer).find("/api/models"), std::string::npos);
}

TEST_F(HttpSessionTest, ReadyAndHealthyAnswer) {
  start();
  EXPECT_EQ(status_of(get("/healthz")), "200");
  EXPECT_EQ(status_of(get("/readyz")), "200");
}

}  // namespace
}  // namespace surfcast::net
