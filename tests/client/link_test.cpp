#include <string>
#include <utility>

#include "net/net_fixture.h"
#include "support/link_relay.h"

namespace surfcast::client {
namespace {

/// A client and a server with a slow and long line between them.
class LinkTest : public net::NetFixture {
 protected:
  static wire::Request noise() { return picture_request("noise", 200, 100); }
  static std::string picture_over(protocol::Endpoint server) {
    auto connection = ServerConnection::open(server, {});
    if (!connection) return connection.error().message;
    const auto answer = connection->ask(noise());
    return answer ? answer->picture().data() : answer.error().message;
  }
};

TEST_F(LinkTest, PicturesComeThroughItAsTheyWere) {
  start();
  const testing::LinkRelay relay(port_, {.bits_per_second = 20e6, .delay = std::chrono::milliseconds(5)});
  const std::string direct = picture_over(endpoint());
  ASSERT_GT(direct.size(), 50'000u);
  EXPECT_EQ(picture_over({"127.0.0.1", relay.port()}), direct);
  EXPECT_EQ(picture_over({"127.0.0.1", relay.port(), true}), direct);
}

TEST_F(LinkTest, AServerThatEndsIsSeenThroughIt) {
  start();
  const testing::LinkRelay relay(port_, {});
  auto connection = ServerConnection::open({"127.0.0.1", relay.port()}, {});
  ASSERT_TRUE(connection);
  stop();
  EXPECT_FALSE(connection->ask(ping_request()));
}

}  // namespace
}  // namespace surfcast::client
