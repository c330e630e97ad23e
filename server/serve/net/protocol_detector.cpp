#include "net/protocol_detector.h"

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/stream_base.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "net/client_name.h"
#include "net/redirect_error_to.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// The first byte of a client that begins with TLS: a record of a handshake. RFC 8446, 5.1.
constexpr std::byte kHandshake{0x16};

using Clock = std::chrono::steady_clock;

class ProtocolDetector : public Session, public std::enable_shared_from_this<ProtocolDetector> {
 public:
  ProtocolDetector(Connection connection, PassOn pass_on)
      : timeout_(connection.stream.get_executor(), connection.peer.context->config.hello),
        connection_(std::move(connection)),
        pass_on_(std::move(pass_on)) {}

  void start() {
    timeout_.async_wait([self = shared_from_this()](error_code code) {
      if (!code) self->abort();
    });
    asio::co_spawn(
        timeout_.get_executor(),
        [](std::shared_ptr<ProtocolDetector> self) -> asio::awaitable<void> {
          co_await self->detect();
          self->timeout_.cancel();
        }(shared_from_this()),
        asio::detached);
  }
  void drain() override { abort(); }
  [[nodiscard]] bool refused() const override {
    return !passed_on_ && !connection_.peer.refusal.empty() && connection_.stream.socket().socket().is_open();
  }
  [[nodiscard]] std::optional<Clock::time_point> idle_since() const override {
    const bool waits =
        !passed_on_ && connection_.peer.refusal.empty() && connection_.stream.socket().socket().is_open();
    return waits ? std::optional(since_) : std::nullopt;
  }
  [[nodiscard]] std::string client() const override {
    return passed_on_ ? std::string() : connection_.peer.open.client();
  }
  void abort() override {
    if (!passed_on_) connection_.stream.socket().close();
  }

 private:
  asio::awaitable<void> detect();
  asio::awaitable<bool> begin_tls();
  [[nodiscard]] std::string refusal_of_plain_text();

  asio::steady_timer timeout_;
  Connection connection_;
  PassOn pass_on_;
  bool passed_on_ = false;
  const Clock::time_point since_ = Clock::now();
};

/// Leaves the first byte in the socket, unless it is encrypted.
asio::awaitable<void> ProtocolDetector::detect() {
  error_code code;
  std::array<std::byte, 1> first{};
  tcp::socket& socket = connection_.stream.socket().socket();
  const size_t count =
      co_await socket.async_receive(asio::buffer(first), tcp::socket::message_peek, redirect_error_to(code));
  if (code || count == 0) co_return;
  if (first[0] == kHandshake && connection_.peer.context->tls) {
    const bool begun = co_await begin_tls();
    if (!begun) co_return;
    co_await connection_.stream.async_read_some(asio::buffer(first), redirect_error_to(code));
    if (code) co_return;
    connection_.begun.assign(first.begin(), first.end());
  }
  if (connection_.peer.refusal.empty()) connection_.peer.refusal = refusal_of_plain_text();
  passed_on_ = true;
  pass_on_(std::move(connection_), first[0] == std::byte{protocol::kHelloMagic[0]});
}

asio::awaitable<bool> ProtocolDetector::begin_tls() {
  const std::shared_ptr<asio::ssl::context> identity = connection_.peer.context->tls;  // a new one may come meanwhile
  error_code code;
  connection_.stream.encrypt(*identity);
  co_await connection_.stream.async_handshake(asio::ssl::stream_base::server, redirect_error_to(code));
  if (code) {
    ++connection_.peer.context->metrics.tls_failures;
    connection_.stream.socket().close();
    co_return false;
  }
  co_return true;
}

/// With a certificate, what other machines say is encrypted. A proxy on this one may speak for them.
std::string ProtocolDetector::refusal_of_plain_text() {
  error_code code;
  const auto peer = connection_.stream.socket().socket().remote_endpoint(code);
  const bool encrypted = connection_.stream.is_encrypted();
  if (code || encrypted || !connection_.peer.context->tls || is_loopback(peer.address())) return {};
  return "this server speaks TLS alone: https://, wss:// and tcps://";
}

}  // namespace

std::shared_ptr<Session> start_protocol_detector(Connection connection, PassOn pass_on) {
  const auto detector = std::make_shared<ProtocolDetector>(std::move(connection), std::move(pass_on));
  detector->start();
  return detector;
}

}  // namespace surfcast::net
