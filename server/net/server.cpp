#include "net/server.h"

#include <algorithm>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <functional>
#include <utility>
#include <vector>

#include "base/log.h"
#include "net/client_name.h"
#include "net/framed_transport.h"
#include "net/http_session.h"
#include "net/message_session.h"
#include "net/redirect_error_to.h"
#include "net/session.h"
#include "protocol/endpoint.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// Connections that are told why they are refused; those beyond are closed without a word. Not a setting: nobody is
/// served by more of them, and less of them save nothing.
constexpr size_t kRefusalsAtOnce = 32;

/// Looks at the first byte of a connection and passes it on to the session of its protocol.
class ProtocolDetector : public Session, public std::enable_shared_from_this<ProtocolDetector> {
 public:
  using PassOn = std::function<void(Connection, bool framed)>;

  ProtocolDetector(Connection connection, PassOn pass_on)
      : timeout_(connection.socket.get_executor(), connection.peer.context->config.hello),
        connection_(std::move(connection)),
        pass_on_(std::move(pass_on)) {}

  void start() {
    timeout_.async_wait([self = shared_from_this()](error_code code) {
      if (!code) self->abort();
    });
    connection_.socket.async_receive(asio::buffer(&first_, 1), tcp::socket::message_peek,
                                     [self = shared_from_this()](error_code code, size_t count) {
                                       self->timeout_.cancel();
                                       if (code || count == 0) return;
                                       const bool framed = self->first_ == protocol::kHelloMagic[0];
                                       self->pass_on_(std::move(self->connection_), framed);
                                     });
  }
  void drain() override { abort(); }
  void abort() override {
    error_code ignored;
    connection_.socket.close(ignored);
  }

 private:
  asio::steady_timer timeout_;
  Connection connection_;
  PassOn pass_on_;
  uint8_t first_ = 0;
};

}  // namespace

struct Server::State {
  State(service::RenderService& service, const ServerConfig& config)
      : context(std::make_shared<NetContext>(NetContext{service, config, {}, 0, false})) {}

  Status listen();
  asio::awaitable<void> accept_all();
  asio::awaitable<void> drain();
  void begin_drain();
  void admit(tcp::socket socket);
  void add(const std::shared_ptr<Session>& session);
  bool any_session();

  asio::io_context io{1};  // outlives what is below
  std::shared_ptr<NetContext> context;
  tcp::acceptor acceptor{io};
  asio::signal_set signals{io};
  std::vector<std::weak_ptr<Session>> sessions;
  service::SessionId last_session = 0;
};

Status Server::State::listen() {
  const ServerConfig& config = context->config;
  error_code code;
  tcp::resolver resolver{io};
  const auto found = resolver.resolve(config.host, std::to_string(config.port), tcp::resolver::passive, code);
  const std::string name = protocol::to_string(protocol::Endpoint{config.host, config.port});
  if (code || found.empty()) return fail(ErrorKind::kIo, name + ": cannot listen: " + code.message());
  const tcp::endpoint endpoint = found.begin()->endpoint();
  acceptor.open(endpoint.protocol(), code);
  if (!code) acceptor.set_option(tcp::acceptor::reuse_address(true), code);
  if (!code) acceptor.bind(endpoint, code);
  if (!code) acceptor.listen(tcp::acceptor::max_listen_connections, code);
  if (code) return fail(ErrorKind::kIo, name + ": cannot listen: " + code.message());
  return {};
}

asio::awaitable<void> Server::State::accept_all() {
  error_code code;
  while (acceptor.is_open()) {
    tcp::socket socket = co_await acceptor.async_accept(redirect_error_to(code));
    if (!code) {
      admit(std::move(socket));
      continue;
    }
    if (!acceptor.is_open()) co_return;
    // Out of descriptors, most likely: they come back as connections end.
    spdlog::warn("cannot accept a connection: {}", code.message());
    asio::steady_timer pause{io, std::chrono::milliseconds(100)};
    co_await pause.async_wait(redirect_error_to(code));
  }
}

void Server::State::admit(tcp::socket socket) {
  Metrics& metrics = context->metrics;
  ++metrics.connections;
  error_code ignored;
  const std::string client = client_name(socket.remote_endpoint(ignored).address());
  std::string refusal = context->clients->refusal_of_connection(client);
  if (!refusal.empty()) {
    ++metrics.connections_refused;
    if (context->clients->all().refused >= kRefusalsAtOnce) return;
  }
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  Counted open(context->clients, client, refusal.empty() ? &Clients::Counts::connections : &Clients::Counts::refused);
  Connection connection{std::move(socket), {context, std::move(open), ++last_session, std::move(refusal)}};
  const auto detector =
      std::make_shared<ProtocolDetector>(std::move(connection), [this](Connection passed, bool framed) {
        if (framed) {
          add(start_message_session(make_framed_transport(std::move(passed.socket), context->config.request_bytes),
                                    std::move(passed.peer)));
        } else {
          add(start_http_session(std::move(passed), [this](const std::shared_ptr<Session>& session) { add(session); }));
        }
      });
  add(detector);
  detector->start();
}

void Server::State::add(const std::shared_ptr<Session>& session) {
  std::erase_if(sessions, [](const auto& weak) { return weak.expired(); });
  sessions.push_back(session);
}

bool Server::State::any_session() {
  return std::ranges::any_of(sessions, [](const auto& weak) { return !weak.expired(); });
}

void Server::State::begin_drain() {
  if (context->draining) return;
  context->draining = true;
  error_code ignored;
  acceptor.close(ignored);
  signals.cancel(ignored);
  asio::co_spawn(io, drain(), asio::detached);
}

asio::awaitable<void> Server::State::drain() {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + context->config.drain;
  const auto each = [this](void (Session::*action)()) {
    for (const auto& weak : std::vector(sessions)) {
      if (const auto session = weak.lock()) (session.get()->*action)();
    }
  };
  each(&Session::drain);
  error_code code;
  asio::steady_timer pause{io};
  while (any_session() && Clock::now() < end) {
    pause.expires_after(std::chrono::milliseconds(5));
    co_await pause.async_wait(redirect_error_to(code));
  }
  each(&Session::abort);
}

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}

Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::create(service::RenderService& service, const ServerConfig& config) {
  auto state = std::make_unique<State>(service, config);
  if (Status status = state->listen(); !status) return fail(status.error());
  return std::unique_ptr<Server>(new Server(std::move(state)));
}

uint16_t Server::port() const {
  error_code ignored;
  return state_->acceptor.local_endpoint(ignored).port();
}

void Server::run(bool until_signal) {
  if (until_signal) {
    state_->signals.add(SIGINT);
    state_->signals.add(SIGTERM);
    state_->signals.async_wait([this](error_code code, int) {
      if (!code) state_->begin_drain();
    });
  }
  asio::co_spawn(state_->io, state_->accept_all(), asio::detached);
  state_->io.run();
}

void Server::models_changed() {
  asio::post(state_->io, [this] {
    for (const auto& weak : std::vector(state_->sessions)) {
      if (const auto session = weak.lock()) session->models_changed();
    }
  });
}

void Server::stop() {
  asio::post(state_->io, [this] { state_->begin_drain(); });
}

}  // namespace surfcast::net
