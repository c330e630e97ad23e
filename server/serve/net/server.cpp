#include "net/server.h"

#include <algorithm>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <exception>
#include <utility>
#include <vector>

#include <sys/socket.h>

#include "base/log.h"
#include "net/client_name.h"
#include "net/file_watch.h"
#include "net/protocol_detector.h"
#include "net/proxy_reader.h"
#include "net/redirect_error_to.h"
#include "net/service_manager.h"
#include "net/session.h"
#include "net/sessions.h"
#include "net/transports.h"
#include "protocol/endpoint.h"
#include "tls/certificate.h"

namespace surfcast::net {
namespace {

using Clock = std::chrono::steady_clock;
namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// Connections that are told why they are refused, or that the server is alive. For one beyond them the oldest is
/// closed: those who know what to say have said it by then. Not a setting: nobody is served by more of them, and less
/// of them save nothing.
constexpr size_t kRefusalsAtOnce = 32;

}  // namespace

struct Server::State {
  State(service::RenderService& service, const ServerConfig& config)
      : context(std::make_shared<NetContext>(NetContext{service, config, {}, 0, false, false})) {}

  Status listen();
  Status adopt(int listener);
  asio::awaitable<void> feed_watchdog(std::chrono::microseconds interval);
  asio::awaitable<void> accept_all();
  asio::awaitable<void> drain();
  asio::awaitable<void> send_away();
  asio::awaitable<void> wait_for_sessions(std::chrono::milliseconds most);
  void tell_all(void (Session::*what)());
  void try_to_admit(tcp::socket socket);
  void begin_drain();
  void await_signal();
  void admit(tcp::socket socket);
  void admit_client(tcp::socket socket, const asio::ip::address& address);
  bool end_idle_for(const std::string& client);
  void begin(Connection connection, bool framed);
  Status use_certificate();
  void reload();
  void reload_tokens();
  asio::awaitable<void> check_users();
  Status watch_files();
  Status open_audit();
  void await_reload();
  void add(const std::shared_ptr<Session>& session);
  bool any_session();
  void end_oldest_refused();

  asio::io_context io{1};  // outlives what is below
  std::shared_ptr<NetContext> context;
  tcp::acceptor acceptor{io};
  asio::signal_set signals{io};
  asio::signal_set reload_signals{io};
  std::shared_ptr<FileWatch> watched;
  asio::steady_timer user_check{io};
  asio::steady_timer watchdog{io};
  bool stopped = false;
  bool hurried = false;  ///< the second signal has come: nobody is waited for to leave
  asio::steady_timer grace{io};
  std::vector<std::weak_ptr<Session>> sessions;
  service::SessionId last_session = 0;
};

/// Takes over the socket of the service manager. Its address is the manager's affair.
Status Server::State::adopt(int listener) {
  error_code code;
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  const bool named = ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  acceptor.assign(named && address.ss_family == AF_INET6 ? tcp::v6() : tcp::v4(), listener, code);
  if (code) return fail(ErrorKind::kIo, "the socket of the service manager is of no use: " + code.message());
  return {};
}

Status Server::State::listen() {
  if (const int listener = inherited_listener(); listener >= 0) return adopt(listener);
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

/// Connections that are open keep the certificate that they began with.
Status Server::State::use_certificate() {
  if (context->config.tls.certificate.empty()) return {};
  Result<tls::ServerIdentity> identity = tls::read_identity(context->config.tls);
  if (!identity) return fail(identity);
  context->tls = std::move(identity->context);
  context->metrics.tls_expires = std::chrono::duration<double>(identity->expires.time_since_epoch()).count();
  return {};
}

/// Reads again what may have changed. What cannot be used leaves the former as it was.
void Server::State::reload() {
  reload_tokens();
  if (const Status opened = context->audit ? context->audit->reopen() : Status(); !opened) {
    spdlog::error("the former audit log is written on: {}", opened.error().message);
  }
  if (context->config.tls.certificate.empty()) return;
  const Status used = use_certificate();
  if (used) return spdlog::info("the certificate was read");
  ++context->metrics.tls_reloads_failed;
  spdlog::error("the former certificate stays: {}", used.error().message);
}

void Server::State::reload_tokens() {
  const Status read = context->gate->read();
  if (!read) return spdlog::error("the former tokens stay: {}", read.error().message);
  tell_all(&Session::check_user);
}

/// Tokens end while time passes. Not a setting: nobody notices a second.
asio::awaitable<void> Server::State::check_users() {
  constexpr std::chrono::seconds kInterval{1};
  error_code code;
  while (!code && !context->draining) {
    user_check.expires_after(kInterval);
    co_await user_check.async_wait(redirect_error_to(code));
    if (!code) tell_all(&Session::check_user);
  }
}

Status Server::State::watch_files() {
  const ServerConfig& config = context->config;
  std::vector<std::filesystem::path> files{config.tls.certificate, config.tls.key, config.tokens};
  std::erase(files, std::filesystem::path());
  if (files.empty()) return {};
  auto watch = FileWatch::start(io.get_executor(), files, [this] { reload(); });
  if (!watch) return fail(watch);
  watched = std::move(*watch);
  return {};
}

Status Server::State::open_audit() {
  if (context->config.audit.empty()) return {};
  auto opened = AuditLog::open(context->config.audit, context->config.log_lines);
  if (!opened) return fail(opened);
  context->audit = std::move(*opened);
  return {};
}

void Server::State::await_reload() {
  reload_signals.async_wait([this](error_code code, int) {
    if (code) return;
    reload();
    await_reload();
  });
}

/// Signs of life of the thread of the sockets, for the service manager.
asio::awaitable<void> Server::State::feed_watchdog(std::chrono::microseconds interval) {
  error_code code;
  while (!code && !stopped) {
    notify_manager("WATCHDOG=1");
    watchdog.expires_after(interval);
    co_await watchdog.async_wait(redirect_error_to(code));
  }
}

asio::awaitable<void> Server::State::accept_all() {
  error_code code;
  while (acceptor.is_open()) {
    tcp::socket socket = co_await acceptor.async_accept(redirect_error_to(code));
    if (!code) {
      try_to_admit(std::move(socket));
      continue;
    }
    if (!acceptor.is_open()) co_return;
    // Out of descriptors, most likely: they come back as connections end.
    log_limited(context->accept_lines, spdlog::level::warn, "cannot accept a connection: " + code.message());
    asio::steady_timer pause{io, std::chrono::milliseconds(100)};
    co_await pause.async_wait(redirect_error_to(code));
  }
}

/// Without memory for one more connection, that one is lost, and no other.
void Server::State::try_to_admit(tcp::socket socket) try {
  admit(std::move(socket));
} catch (const std::exception& error) {
  spdlog::error("a connection is lost: {}", error.what());
}

void Server::State::admit(tcp::socket socket) {
  error_code ignored;
  const asio::ip::address address = socket.remote_endpoint(ignored).address();
  if (!context->config.trusted_proxies.contain(address)) return admit_client(std::move(socket), address);
  add(start_proxy_reader(std::move(socket), context->config.hello, [this](tcp::socket passed, const auto& client) {
    if (!context->draining) admit_client(std::move(passed), client);
  }));
}

void Server::State::admit_client(tcp::socket socket, const asio::ip::address& address) {
  Metrics& metrics = context->metrics;
  ++metrics.connections;
  error_code ignored;
  const std::string client = client_name(address);
  std::string refusal = context->clients->refusal_of_connection(client);
  if (!refusal.empty() && end_idle_for(client)) refusal.clear();
  if (!refusal.empty()) {
    ++metrics.connections_refused;
    if (context->clients->all().refused >= kRefusalsAtOnce) end_oldest_refused();
  }
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  Counted open(context->clients, client, refusal.empty() ? &Clients::Counts::connections : &Clients::Counts::refused);
  Connection connection{ClientStream(boost::beast::tcp_stream(std::move(socket))),
                        {context, std::move(open), ++last_session, std::move(refusal)}};
  add(start_protocol_detector(std::move(connection),
                              [this](Connection passed, bool framed) { begin(std::move(passed), framed); }));
}

void Server::State::begin(Connection connection, bool framed) {
  if (framed) {
    add(start_message_session(
        make_framed_transport(std::move(connection.stream), std::move(connection.begun), context->config.request_bytes),
        std::move(connection.peer)));
  } else {
    add(start_http_session(std::move(connection), [this](const std::shared_ptr<Session>& session) { add(session); }));
  }
}

void Server::State::add(const std::shared_ptr<Session>& session) {
  std::erase_if(sessions, [](const auto& weak) { return weak.expired(); });
  sessions.push_back(session);
}

/// Ends the connection that has been idle for longest: one of this client, if it has all that it may have. False if all
/// are in use.
bool Server::State::end_idle_for(const std::string& client) {
  const bool own = context->clients->has_all_its_connections(client);
  std::shared_ptr<Session> oldest;
  Clock::time_point since = Clock::now() - context->config.give_way;
  for (const auto& weak : sessions) {
    const auto session = weak.lock();
    const auto idle = session ? session->idle_since() : std::nullopt;
    if (!idle || *idle > since || (own && session->client() != client)) continue;
    since = *idle;
    oldest = session;
  }
  if (!oldest) return false;
  ++context->metrics.connections_given_way;
  oldest->abort();
  return true;
}

void Server::State::end_oldest_refused() {
  for (const auto& weak : sessions) {
    const auto session = weak.lock();
    if (session && session->refused()) return session->abort();
  }
}

bool Server::State::any_session() {
  return std::ranges::any_of(sessions, [](const auto& weak) { return !weak.expired(); });
}

/// The second time it ends the grace of the first.
void Server::State::begin_drain() {
  if (std::exchange(context->leaving, true)) {
    hurried = true;
    grace.cancel();
    return;
  }
  notify_manager("STOPPING=1");
  asio::co_spawn(io, drain(), asio::detached);
}

void Server::State::await_signal() {
  signals.async_wait([this](error_code code, int) {
    if (code) return;
    begin_drain();
    if (!context->draining) await_signal();
  });
}

/// Calls every session.
void Server::State::tell_all(void (Session::*what)()) {
  for (const auto& weak : std::vector(sessions)) {
    if (const auto session = weak.lock()) (session.get()->*what)();
  }
}

/// Waits until no session is left, but no longer than this.
asio::awaitable<void> Server::State::wait_for_sessions(std::chrono::milliseconds most) {
  const Clock::time_point end = Clock::now() + most;
  error_code code;
  asio::steady_timer pause{io};
  while (any_session() && Clock::now() < end) {
    pause.expires_after(std::chrono::milliseconds(5));
    co_await pause.async_wait(redirect_error_to(code));
  }
}

/// Clients with views would all come back elsewhere at once: they go one after the other.
asio::awaitable<void> Server::State::send_away() {
  std::vector<std::weak_ptr<Session>> lasting;
  for (const auto& weak : std::vector(sessions)) {
    const auto session = weak.lock();
    if (session && session->lasts()) {
      lasting.push_back(weak);
    } else if (session) {
      session->drain();
    }
  }
  error_code code;
  for (size_t i = 0; i < lasting.size() && !hurried; ++i) {
    if (const auto session = lasting[i].lock()) session->drain();
    grace.expires_after(context->config.leave / lasting.size());
    co_await grace.async_wait(redirect_error_to(code));
  }
}

/// Those who choose a server for their clients see first that this one is not ready any more, and send nobody here.
/// Then nothing new is begun, what is outstanding is finished, and what is not finished in time is answered with an
/// error.
asio::awaitable<void> Server::State::drain() {
  constexpr std::chrono::milliseconds kForAnswers{1000};
  error_code code;
  grace.expires_after(context->config.grace);
  co_await grace.async_wait(redirect_error_to(code));
  acceptor.close(code);
  co_await send_away();
  context->draining = true;
  signals.cancel(code);
  reload_signals.cancel(code);
  if (watched) watched->stop();
  user_check.cancel();
  tell_all(&Session::drain);
  co_await wait_for_sessions(context->config.drain);
  tell_all(&Session::give_up);
  co_await wait_for_sessions(std::min(kForAnswers, context->config.drain));
  tell_all(&Session::abort);
  stopped = true;
  watchdog.cancel();
}

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}

Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::create(service::RenderService& service, const ServerConfig& config) {
  auto state = std::make_unique<State>(service, config);
  state->context->config.hosts.push_back(config.host);
  if (Status status = state->use_certificate(); !status) return fail(status);
  if (Status status = state->context->gate->read(); !status) return fail(status);
  if (Status status = state->watch_files(); !status) return fail(status);
  if (Status status = state->open_audit(); !status) return fail(status);
  if (Status status = state->listen(); !status) return fail(status);
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
    state_->await_signal();
    state_->reload_signals.add(SIGHUP);
    state_->await_reload();
    if (const auto interval = watchdog_interval()) {
      asio::co_spawn(state_->io, state_->feed_watchdog(*interval), asio::detached);
    }
    notify_manager("READY=1");
  }
  asio::co_spawn(state_->io, state_->accept_all(), asio::detached);
  if (state_->context->gate->wants_tokens()) asio::co_spawn(state_->io, state_->check_users(), asio::detached);
  for (bool running = true; running;) {
    try {
      state_->io.run();
      running = false;
    } catch (const std::exception& error) {  // out of memory, in one of many things that go on at once
      spdlog::error("unexpected: {}", error.what());
    }
  }
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
