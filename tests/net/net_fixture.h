#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "client/server_connection.h"
#include "net/raw_socket.h"
#include "net/server.h"
#include "protocol/errors.h"
#include "service/fake_models.h"
#include "service/render_service.h"

namespace surfcast::net {

using std::chrono::milliseconds;

/// A server of the fake models on a free port of the loopback, with its own thread.
class NetFixture : public ::testing::Test {
 protected:
  void TearDown() override { stop(); }

  /// `port` 0: any free one.
  void start(ServerConfig config = {}, const service::ServiceLimits& limits = {}, uint16_t port = 0) {
    auto service = service::RenderService::start(models_, service::fake_renderers(control_), limits);
    ASSERT_TRUE(service);
    service_ = std::move(*service);
    config.port = port;
    config.hosts.emplace_back("here");
    auto server = Server::create(*service_, config);
    ASSERT_TRUE(server);
    server_ = std::move(*server);
    port_ = server_->port();
    thread_ = std::jthread([this] { server_->run(false); });
  }
  void stop() {
    if (!server_) return;
    server_->stop();
    thread_.join();
    server_.reset();
    service_.reset();
  }

  [[nodiscard]] protocol::Endpoint endpoint() const { return {"127.0.0.1", port_}; }
  [[nodiscard]] Result<client::ServerConnection> connect() const {
    return client::ServerConnection::open(endpoint(),
                                          {.connect = milliseconds(10'000), .answer = milliseconds(20'000)});
  }
  /// Polls until `condition` holds; false after ten seconds.
  template <typename Condition>
  static bool eventually(Condition condition) {
    for (int i = 0; i < 10'000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
  }
  [[nodiscard]] std::string http(const std::string& request) const {
    RawSocket socket(port_);
    socket.send(request);
    return socket.read_http();
  }
  [[nodiscard]] std::string get(const std::string& target) const {
    return http("GET " + target + " HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
  }
  /// The value of a line of /metrics; -1 without one.
  [[nodiscard]] long metric(const std::string& name) const {
    const std::string text = get("/metrics");
    const size_t place = text.find("\n" + name + " ");
    return place == std::string::npos ? -1 : std::stol(text.substr(place + name.size() + 2));
  }

  static wire::Request picture_request(const std::string& model, uint32_t width = 8, uint32_t height = 4) {
    wire::Request request;
    request.mutable_draw_picture()->set_model(model);
    request.mutable_draw_picture()->mutable_resolution()->set_width(width);
    request.mutable_draw_picture()->mutable_resolution()->set_height(height);
    return request;
  }
  static wire::Request ping_request() {
    wire::Request request;
    request.mutable_ping();
    return request;
  }

  service::FakeModels models_;
  std::shared_ptr<service::FakeRendererControl> control_ = std::make_shared<service::FakeRendererControl>();
  std::unique_ptr<service::RenderService> service_;
  std::unique_ptr<Server> server_;
  uint16_t port_ = 0;
  std::jthread thread_;
};

}  // namespace surfcast::net
