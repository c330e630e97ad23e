#include "net/clients.h"

#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "net/client_name.h"
#include "net/net_fixture.h"
#include "net/raw_websocket.h"
#include "protocol/framing.h"

namespace surfcast::net {
namespace {

using ::testing::HasSubstr;

TEST(ClientNameTest, AnAddressOfVersion4IsAClient) {
  EXPECT_EQ(client_name(boost::asio::ip::make_address("192.0.2.7")), "192.0.2.7");
  EXPECT_EQ(client_name(boost::asio::ip::make_address("::ffff:192.0.2.7")), "192.0.2.7");
}

TEST(ClientNameTest, ANetworkOfVersion6IsAClient) {
  const std::string one = client_name(boost::asio::ip::make_address("2001:db8:1:2:3:4:5:6"));
  EXPECT_EQ(one, "2001:db8:1:2::/64");
  EXPECT_EQ(client_name(boost::asio::ip::make_address("2001:db8:1:2:ffff::1")), one);
  EXPECT_NE(client_name(boost::asio::ip::make_address("2001:db8:1:3::1")), one);
}

TEST(ClientsTest, WhatIsCountedEndsWithWhatCountsIt) {
  const auto clients =
      std::make_shared<Clients>(ClientLimits{.connections = 3, .connections_per_client = 2, .views_per_client = 1});
  std::optional<Counted> view(std::in_place, clients, "a", &Clients::Counts::views);
  EXPECT_THAT(clients->refusal_of_view("a"), HasSubstr("from a"));
  EXPECT_EQ(clients->refusal_of_view("b"), "");
  view.reset();
  EXPECT_EQ(clients->refusal_of_view("a"), "");
  Counted first(clients, "a", &Clients::Counts::connections);
  const Counted moved(std::move(first));
  const Counted refused(clients, "a", &Clients::Counts::refused);
  EXPECT_EQ(clients->refusal_of_connection("a"), "") << "what is refused takes no place";
  std::optional<Counted> second(std::in_place, clients, "a", &Clients::Counts::connections);
  EXPECT_THAT(clients->refusal_of_connection("a"), HasSubstr("too many connections from a: the server takes 2"));
  EXPECT_EQ(clients->refusal_of_connection("b"), "");
  const Counted other(clients, "b", &Clients::Counts::connections);
  EXPECT_THAT(clients->refusal_of_connection("c"), HasSubstr("the server is busy: too many connections"));
  second.reset();
  EXPECT_EQ(clients->all().connections, 2U);
  EXPECT_EQ(clients->all().refused, 1U);
}

class ClientLimitsTest : public NetFixture {
 protected:
  static constexpr const char* kOther = "127.0.0.2";

  [[nodiscard]] std::string get_from(const char* address, const std::string& target) const {
    RawSocket socket(port_, 0, address);
    socket.send("GET " + target + " HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
    return socket.read_http();
  }
  static wire::Request open_view_request() {
    wire::Request request;
    *request.mutable_open_view()->mutable_picture() = picture_request("cube").draw_picture();
    return request;
  }
};

TEST_F(ClientLimitsTest, ConnectionsOfOneAddressBeyondItsLimitAreToldSo) {
  ServerConfig config;
  config.clients.connections_per_client = 1;
  config.give_way = std::chrono::hours(1);
  start(config);
  {
    auto first = connect();
    ASSERT_TRUE(first);
    const auto second = connect();
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(second.error().message, HasSubstr("too many connections from 127.0.0.1"));
    const std::string refused = get("/api/models");
    EXPECT_THAT(refused, HasSubstr("HTTP/1.1 503"));
    EXPECT_THAT(refused, HasSubstr("Retry-After"));
    EXPECT_THAT(refused, HasSubstr("\"kind\": \"unavailable\""));
    RawWebSocket socket(port_);
    socket.send_hello();
    const std::string hello = socket.read_message();
    EXPECT_EQ(protocol::decode_hello(std::as_bytes(std::span(hello)))->status, protocol::HelloStatus::kBusy);
    EXPECT_THAT(get_from(kOther, "/healthz"), HasSubstr("HTTP/1.1 200"));
    EXPECT_TRUE(first->ask(ping_request()));
  }
  EXPECT_TRUE(eventually([this] { return get("/api/models").find("HTTP/1.1 200") != std::string::npos; }));
}

TEST_F(ClientLimitsTest, RefusedConnectionsTakeNobodysPlace) {
  ServerConfig config;
  config.clients = {.connections = 2, .connections_per_client = 1};
  config.give_way = std::chrono::hours(1);
  start(config);
  auto first = connect();
  ASSERT_TRUE(first);
  std::vector<RawSocket> refused;  // they stay open, and say nothing
  for (int i = 0; i < 10; ++i) refused.emplace_back(port_);
  // One request: a second one could arrive before the connection of the first has ended, and be refused, too.
  const std::string metrics = get_from(kOther, "/metrics");
  EXPECT_THAT(metrics, HasSubstr("HTTP/1.1 200"));
  EXPECT_THAT(metrics, HasSubstr("surfcast_connections_refused_total 10"));
  EXPECT_THAT(metrics, HasSubstr("surfcast_connections_open 12"));
}

TEST_F(ClientLimitsTest, OneClientLeavesConnectionsToOthers) {
  start();
  const ClientLimits limits;
  std::vector<RawSocket> silent;
  for (size_t i = 0; i < limits.connections + 40; ++i) silent.emplace_back(port_);
  EXPECT_THAT(get_from(kOther, "/api/models"), HasSubstr("HTTP/1.1 200"));
}

TEST_F(ClientLimitsTest, HealthIsAnsweredWhenEveryPlaceIsTaken) {
  ServerConfig config;
  config.clients = {.connections = 4, .connections_per_client = 0};
  config.give_way = std::chrono::hours(1);
  start(config);
  std::vector<RawSocket> silent;  // more than are served and told why they are not
  for (int i = 0; i < 60; ++i) silent.emplace_back(port_);
  EXPECT_THAT(get("/healthz"), HasSubstr("HTTP/1.1 200"));
  EXPECT_THAT(get("/readyz"), HasSubstr("HTTP/1.1 200"));
  EXPECT_THAT(get("/metrics"), HasSubstr("HTTP/1.1 503"));
}

// Of each protocol one, and all that are silent.
TEST_F(ClientLimitsTest, IdleConnectionsOfAClientGiveWayToItsNextOne) {
  ServerConfig config;
  config.clients.connections_per_client = 4;
  config.give_way = milliseconds(0);
  start(config);
  RawSocket silent(port_);
  auto framed = connect();
  ASSERT_TRUE(framed && framed->ask(ping_request()));
  RawSocket http(port_);
  ASSERT_TRUE(http.send("GET /healthz HTTP/1.1\r\nHost: here\r\n\r\n"));
  EXPECT_THAT(http.read_http(), HasSubstr("HTTP/1.1 200"));
  RawWebSocket websocket(port_);
  websocket.send_hello();
  (void)websocket.read_message();
  std::vector<RawSocket> next;
  for (int i = 0; i < 4; ++i) {
    next.emplace_back(port_);
    ASSERT_TRUE(next.back().send("GET /api/models HTTP/1.1\r\nHost: here\r\n\r\n"));
    EXPECT_THAT(next.back().read_http(), HasSubstr("HTTP/1.1 200"));
  }
  EXPECT_TRUE(silent.closed_within(RawSocket::kPatience));
  EXPECT_TRUE(http.closed_within(RawSocket::kPatience));
  EXPECT_FALSE(framed->ask(ping_request()));
  EXPECT_EQ(websocket.read_message(), "") << "it is closed";
}

TEST_F(ClientLimitsTest, ConnectionsInUseGiveWayToNobody) {
  ServerConfig config;
  config.clients.connections_per_client = 2;
  config.give_way = milliseconds(0);
  start(config);
  auto viewing = connect();
  ASSERT_TRUE(viewing);
  const auto view = viewing->send(open_view_request());
  ASSERT_TRUE(view && viewing->receive()->has_view_frame());
  auto other = connect();
  ASSERT_TRUE(other);
  ASSERT_TRUE(other->send(open_view_request()));
  ASSERT_TRUE(other->receive()->has_view_frame());
  EXPECT_THAT(get("/api/models"), HasSubstr("HTTP/1.1 503"));
  EXPECT_THAT(get_from(kOther, "/api/models"), HasSubstr("HTTP/1.1 200"));
}

TEST_F(ClientLimitsTest, AnIdleConnectionOfAnyClientGivesWayWhereAllPlacesAreTaken) {
  ServerConfig config;
  config.clients = {.connections = 3, .connections_per_client = 0};
  config.give_way = milliseconds(0);
  start(config);
  std::vector<RawSocket> silent;
  for (int i = 0; i < 3; ++i) silent.emplace_back(port_);
  EXPECT_THAT(get_from(kOther, "/api/models"), HasSubstr("HTTP/1.1 200"));
  EXPECT_TRUE(silent.front().closed_within(RawSocket::kPatience));
}

TEST_F(ClientLimitsTest, ViewsOfOneAddressCountOnAllItsConnections) {
  ServerConfig config;
  config.clients.views_per_client = 1;
  start(config);
  auto first = connect();
  auto second = connect();
  ASSERT_TRUE(first && second);
  const auto view = first->send(open_view_request());
  ASSERT_TRUE(view && first->receive()->has_view_frame());
  const auto refusal = second->ask(open_view_request());
  ASSERT_FALSE(refusal);
  EXPECT_EQ(refusal.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(refusal.error().message, HasSubstr("too many views are open from 127.0.0.1"));
  wire::Request close;
  close.mutable_close_view()->set_view(*view);
  ASSERT_TRUE(first->send(close));
  while (!first->receive()->has_view_closed()) {
  }
  ASSERT_TRUE(second->send(open_view_request()));
  EXPECT_TRUE(second->receive()->has_view_frame());
}

TEST_F(ClientLimitsTest, AMessageIsMeasuredByTheServersOwnLimit) {
  ServerConfig config;
  config.request_bytes = 1024;
  start(config);
  wire::Request request = picture_request(std::string(1024, 'm'));
  auto connection = connect();
  ASSERT_TRUE(connection);
  const auto refusal = connection->ask(request);
  ASSERT_FALSE(refusal);
  EXPECT_THAT(refusal.error().message, HasSubstr("larger than the limit of 1024"));
  RawWebSocket socket(port_);
  socket.send_hello();
  socket.read_message();
  socket.send(RawWebSocket::kBinary, request.SerializeAsString());
  EXPECT_EQ(socket.read_close(), 1009U);
}

TEST_F(ClientLimitsTest, AHeaderOfHttpIsMeasuredByTheServersOwnLimit) {
  ServerConfig config;
  config.http_header_bytes = 1024;
  start(config);
  EXPECT_THAT(get("/healthz?" + std::string(2000, 'x')), HasSubstr("HTTP/1.1 431"));
}

TEST_F(ClientLimitsTest, MemoryOfTheRendererIsAMetric) {
  start();
  EXPECT_EQ(metric("surfcast_gpu_memory_budget_bytes"), 3000);
  EXPECT_EQ(metric("surfcast_host_memory_budget_bytes"), 2000);
}

}  // namespace
}  // namespace surfcast::net
