#include "net/http_session.h"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <utility>

#include "net/beast_text.h"
#include "net/http_annotations.h"
#include "net/http_answer.h"
#include "net/http_connection.h"
#include "net/http_credentials.h"
#include "net/http_login.h"
#include "net/http_places.h"
#include "net/http_route.h"
#include "net/http_upload.h"
#include "net/message_session.h"
#include "net/redirect_error_to.h"
#include "net/request_guard.h"
#include "net/trace.h"
#include "net/upgrade.h"
#include "net/websocket_transport.h"
#include "service/model_name.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

unsigned status_of(const error_code& code) {
  if (code == http::error::header_limit) return 431;
  return code == http::error::body_limit ? 413 : 400;
}

UpgradeRequest upgrade_of(const UpgradeHead& request) {
  return {origin_of(request), view_of(request[http::field::sec_websocket_protocol])};
}

RequestHead guarded_head_of(const HeadParser::value_type& request) {
  return {.version = request.version(),
          .get = request.method() == http::verb::get || request.method() == http::verb::head,
          .hosts = request.count(http::field::host),
          .host = view_of(request[http::field::host]),
          .transfer_encodings = request.count(http::field::transfer_encoding),
          .transfer_encoding = view_of(request[http::field::transfer_encoding]),
          .content_length = request.count(http::field::content_length) > 0,
          .origin = view_of(request[http::field::origin]),
          .forwarded_scheme = view_of(request["X-Forwarded-Proto"]),
          .fetch_site = view_of(request["Sec-Fetch-Site"]),
          .fetch_mode = view_of(request["Sec-Fetch-Mode"]),
          .fetch_destination = view_of(request["Sec-Fetch-Dest"])};
}

HttpCredentials credentials_of(const HeadParser::value_type& request) {
  return {view_of(request[http::field::authorization]), view_of(request[http::field::cookie]),
          view_of(request[http::field::sec_websocket_protocol])};
}

/// Whether a request changes who is logged in.
bool is_login(const HeadParser::value_type& request) {
  const Result<HttpRoute> route = route_http(view_of(request.target()));
  return route && request.method() == http::verb::post &&
         (route->kind == HttpRoute::Kind::kLogin || route->kind == HttpRoute::Kind::kLogout);
}

/// Whether a request may have a body.
bool takes_body(const HeadParser::value_type& request) {
  return is_upload(request) || is_annotation_write(request) || is_login(request);
}

/// The file of the viewer that a target names, query left out.
const StaticFile* find_file(const ServerConfig& config, std::string_view target) {
  return config.viewer ? config.viewer->find(target.substr(0, target.find('?'))) : nullptr;
}

class HttpSession : public Session, public std::enable_shared_from_this<HttpSession> {
 public:
  using Clock = std::chrono::steady_clock;

  HttpSession(Connection connection, AdoptSession adopt, const service::Asker& asker)
      : connection_(
            std::make_shared<HttpConnection>(std::move(connection.stream), connection.begun, connection.peer.context)),
        context_(std::move(connection.peer.context)),
        open_(std::move(connection.peer.open)),
        asker_(asker),
        refusal_(std::move(connection.peer.refusal)),
        adopt_(std::move(adopt)),
        places_(std::make_shared<HttpPlaces>(context_, connection_, asker_)) {}

  void start() {
    asio::co_spawn(
        connection_->stream().get_executor(),
        [](std::shared_ptr<HttpSession> self) -> asio::awaitable<void> { co_await self->serve(); }(shared_from_this()),
        asio::detached);
  }
  void drain() override {
    if (!answering_) abort();
  }
  void give_up() override {
    if (!places_->cancel()) abort();
  }
  [[nodiscard]] bool refused() const override { return !refusal_.empty() && !aborted_; }
  [[nodiscard]] std::optional<Clock::time_point> idle_since() const override {
    const bool waits = !answering_ && !passed_on_ && !aborted_ && refusal_.empty();
    return waits ? std::optional(idle_since_) : std::nullopt;
  }
  [[nodiscard]] std::string client() const override { return open_.client(); }
  void abort() override {
    aborted_ = true;
    places_->cancel();
    if (!passed_on_) connection_->close();
  }
  /// Ends a request that is being answered, or a scan that is being received, with its token.
  void check_guest() override {
    if (!guest_ || !answering_ || passed_on_ || aborted_) return;
    const std::string reason = context_->gate->why_ended(guest_);
    if (reason.empty()) return;
    audit({.what = "token", .outcome = "denied", .reason = reason});
    abort();
  }

 private:
  using Parser = HeadParser;

  asio::awaitable<void> serve();
  asio::awaitable<bool> serve_one();
  [[nodiscard]] std::optional<HttpAnswer> refusal_of_head(const Parser& parser, const error_code& code) const;
  asio::awaitable<bool> serve_upload(Parser& parser);
  asio::awaitable<bool> serve_login(Parser& parser);
  asio::awaitable<bool> serve_annotations(Parser& parser);
  asio::awaitable<HttpAnswer> answer_annotation_write(Parser& parser);
  asio::awaitable<HttpAnswer> answer_login(Parser& parser);
  void identify(const Parser::value_type& request);
  [[nodiscard]] bool may_upload(const Parser::value_type& request) const;
  [[nodiscard]] std::string refusal_of_guest() const;
  asio::awaitable<void> wait_for_penalty();
  asio::awaitable<HttpAnswer> deny(const Parser::value_type& request);
  asio::awaitable<HttpAnswer> answer(const Parser::value_type& request);
  void audit(AuditEvent event) const;
  void audit_route(const HttpRoute& route) const;
  bool become_websocket(const Parser::value_type& request);
  [[nodiscard]] HttpAnswer refuse_websocket(const Parser::value_type& request) const;

  std::shared_ptr<HttpConnection> connection_;
  std::shared_ptr<NetContext> context_;
  Counted open_;
  service::Asker asker_;
  std::string refusal_;  ///< as in Peer
  AdoptSession adopt_;
  bool answering_ = false;
  bool aborted_ = false;
  bool passed_on_ = false;  ///< the connection is a WebSocket's
  std::shared_ptr<HttpPlaces> places_;
  Clock::time_point idle_since_ = Clock::now();  ///< while no request is answered
  Gatekeeper::Guest guest_;                      ///< of the request that is answered
  std::optional<Counted> counted_guest_;
};

asio::awaitable<void> HttpSession::serve() {
  bool going_on = true;
  while (going_on) {
    going_on = co_await serve_one();
    idle_since_ = Clock::now();
  }
  if (!passed_on_ && connection_->is_open()) co_await connection_->linger();
}

/// The answer to a request that is refused for its head alone. The connection ends with it: where a next request would
/// begin is not certain, or the client is not welcome.
std::optional<HttpAnswer> HttpSession::refusal_of_head(const Parser& parser, const error_code& code) const {
  if (code) {
    return error_answer({ErrorKind::kInvalidInput, "not a request of HTTP/1.1: " + code.message()}, status_of(code));
  }
  const ServerConfig& config = context_->config;
  const auto refusal = refusal_of(guarded_head_of(parser.get()), {config.hosts, config.allowed_origins});
  if (refusal) return error_answer(refusal->error, refusal->status);
  if (parser.is_done() || (refusal_.empty() && takes_body(parser.get()))) {
    return std::nullopt;
  }
  return error_answer({ErrorKind::kLimit, "requests with a body are not accepted here"}, 413);
}

/// Reads one request and answers it. False when the connection is at its end.
asio::awaitable<bool> HttpSession::serve_one() {
  Parser parser;
  parser.header_limit(context_->config.http_header_bytes);
  parser.body_limit(boost::none);  // what is no upload is refused before its body is read
  const error_code code = co_await connection_->read_head(parser);
  if (code == http::error::end_of_stream || !connection_->is_open()) co_return false;
  if (code && code.category() != http::make_error_code(http::error::bad_method).category()) co_return false;
  ++context_->metrics.requests;
  if (connection_->stream().is_encrypted()) parser.get().set("X-Forwarded-Proto", "https");  // as a proxy would say
  const Parser::value_type& request = parser.get();
  const std::optional<HttpAnswer> refused = refusal_of_head(parser, code);
  if (!refused) identify(request);
  if (!refused && parser.is_done() && become_websocket(request)) co_return false;
  answering_ = true;
  if (!refused && refusal_.empty() && is_login(request)) co_return co_await serve_login(parser);
  if (!refused && refusal_.empty() && is_annotation_write(request)) co_return co_await serve_annotations(parser);
  if (!refused && refusal_.empty() && may_upload(request)) co_return co_await serve_upload(parser);
  HttpAnswer result;
  if (refused) {
    result = *refused;
  } else {
    result = co_await answer(request);
  }
  if (result.status >= 400) ++context_->metrics.errors;
  std::string trace = answered_trace(view_of(request["traceparent"]));
  if (!trace.empty()) result.headers.emplace_back("traceparent", std::move(trace));
  const bool keep_alive =
      !refused && parser.is_done() && request.keep_alive() && !context_->leaving && refusal_.empty();
  const bool head = !code && request.method() == http::verb::head;
  const AnswerForm form{code ? 11 : request.version(), keep_alive, head};
  const bool written = co_await connection_->write(result, form);
  answering_ = false;
  // The server may have begun to stop during the write.
  const bool going_on = written && keep_alive && !context_->leaving;
  co_return going_on;
}

/// Finds out who asks. Turns of the renderer go to a guest, on whatever connections it comes.
void HttpSession::identify(const Parser::value_type& request) {
  const std::string_view token = token_of(credentials_of(request));
  guest_ = token.empty() ? nullptr : context_->gate->enter(token, open_.client());
  const bool wrong = !token.empty() && !guest_ && context_->gate->wants_tokens();
  if (wrong) audit({.what = "token", .outcome = "denied"});
  service::Asker asker = asker_;
  if (guest_) asker.client = std::hash<std::string>()("token " + guest_->name);
  places_->set_guest(guest_, asker);
  const bool same = guest_ && counted_guest_ && counted_guest_->client() == guest_->name;
  if (same) return;
  counted_guest_.reset();
  if (!guest_ || !refusal_of_guest().empty()) return;
  counted_guest_.emplace(context_->gate->guests(), guest_->name, &Clients::Counts::connections);
  audit({.what = "token", .outcome = "allowed"});
}

/// Adds who it is and where from.
void HttpSession::audit(AuditEvent event) const {
  if (!context_->audit) return;
  event.client = open_.client();
  event.connection = asker_.session;
  if (guest_) event.who = guest_->name;
  context_->audit->write(event);
}

/// What is asked of a model.
void HttpSession::audit_route(const HttpRoute& route) const {
  const std::string_view what = route.kind == HttpRoute::Kind::kPicture       ? "picture"
                                : route.kind == HttpRoute::Kind::kPick        ? "pick"
                                : route.kind == HttpRoute::Kind::kProfile     ? "profile"
                                : route.kind == HttpRoute::Kind::kPoints      ? "points"
                                : route.kind == HttpRoute::Kind::kModel       ? "describe"
                                : route.kind == HttpRoute::Kind::kAnnotations ? "annotations"
                                                                              : "";
  if (what.empty()) return;
  const bool allowed = !guest_ || access::may_see(*guest_, route.model);
  audit({.what = what, .model = route.model, .outcome = allowed ? "allowed" : "denied"});
}

/// Why a guest who may come in has to wait; empty: it has not.
std::string HttpSession::refusal_of_guest() const {
  if (!guest_ || counted_guest_ || guest_->connections == 0) return {};
  if (context_->gate->guests()->counts_of(guest_->name).connections < guest_->connections) return {};
  return "busy: this token opens " + std::to_string(guest_->connections) + " connections at a time";
}

/// Whether a scan is begun by somebody who may send one under that name.
bool HttpSession::may_upload(const Parser::value_type& request) const {
  if (!is_upload(request) || !context_->gate->admits(guest_) || !refusal_of_guest().empty()) return false;
  if (!guest_) return true;
  const std::string name = service::model_name(route_http(view_of(request.target()))->model);
  return guest_->uploads && access::may_see(*guest_, name);
}

asio::awaitable<void> HttpSession::wait_for_penalty() {
  error_code ignored;
  connection_->wait_without_limit();
  asio::steady_timer penalty(connection_->stream().get_executor(), context_->gate->penalty(open_.client()));
  co_await penalty.async_wait(redirect_error_to(ignored));
}

/// The answer to somebody who may not ask. A browser gets a page to log in.
asio::awaitable<HttpAnswer> HttpSession::deny(const Parser::value_type& request) {
  co_await wait_for_penalty();
  const Result<HttpRoute> route = route_http(view_of(request.target()));
  const bool page = route && route->kind == HttpRoute::Kind::kPage && request.method() == http::verb::get;
  co_return page ? login_page("") : denied_answer();
}

asio::awaitable<HttpAnswer> HttpSession::answer_login(Parser& parser) {
  constexpr size_t kMostBytes = 1024;  // of the form
  const bool encrypted = view_of(parser.get()["X-Forwarded-Proto"]) == "https";
  const Status page = check_origin(origin_of(parser.get()), context_->config.allowed_origins);
  if (!page) co_return error_answer(page.error(), 403);
  const bool logout = route_http(view_of(parser.get().target()))->kind == HttpRoute::Kind::kLogout;
  const std::optional<std::string> form = co_await connection_->read_body(parser, kMostBytes);
  if (!form) co_return error_answer({ErrorKind::kInvalidInput, "this is no form with a token"}, 400);
  if (logout) co_return login_answer(login_cookie("", encrypted));
  const std::string token = token_of_form(*form);
  const Gatekeeper::Guest guest = context_->gate->enter(token, open_.client());
  audit({.what = "login", .who = guest ? guest->name : "", .outcome = guest ? "allowed" : "denied"});
  if (guest) co_return login_answer(login_cookie(token, encrypted));
  co_await wait_for_penalty();
  co_return login_page("This token is not known here, or has ended.");
}

/// False: the connection ends. A browser opens another.
asio::awaitable<bool> HttpSession::serve_login(Parser& parser) {
  const AnswerForm form{parser.get().version(), /*keep_alive=*/false, /*head=*/false};
  const HttpAnswer result = co_await answer_login(parser);
  co_await connection_->write(result, form);
  answering_ = false;
  co_return false;
}

asio::awaitable<HttpAnswer> HttpSession::answer_annotation_write(Parser& parser) {
  if (!context_->gate->admits(guest_)) co_return co_await deny(parser.get());
  if (const std::string busy = refusal_of_guest(); !busy.empty()) {
    const Error error{ErrorKind::kUnavailable, busy};
    co_return error_answer(error, 429);
  }
  AnnotationRequest request{route_http(view_of(parser.get().target()))->model, guest_, asker_};
  const std::string model = request.model;
  HttpAnswer result = forbidden_answer();
  if (may_annotate(guest_, model)) {
    result = co_await receive_annotations(*context_, *connection_, parser, std::move(request));
  }
  audit({.what = "annotate", .model = model, .outcome = result.status < 400 ? "allowed" : "denied"});
  co_return result;
}

/// False: the connection ends.
asio::awaitable<bool> HttpSession::serve_annotations(Parser& parser) {
  const unsigned version = parser.get().version();
  const HttpAnswer result = co_await answer_annotation_write(parser);
  if (result.status >= 400) ++context_->metrics.errors;
  const AnswerForm form{version, /*keep_alive=*/false, /*head=*/false};
  co_await connection_->write(result, form);
  answering_ = false;
  co_return false;
}

/// Receives a scan and answers. False when the connection is at its end.
asio::awaitable<bool> HttpSession::serve_upload(Parser& parser) {
  const unsigned version = parser.get().version();
  bool keep_alive = parser.keep_alive();
  const std::string uploaded = route_http(view_of(parser.get().target()))->model;
  const std::string sender = guest_ ? guest_->name : std::string();  // named: see on_disk in http_upload.cpp
  const UploadOutcome outcome = co_await receive_scan(*context_, *connection_, parser, sender);
  const bool taken = outcome.answer.status < 400;
  audit({.what = "upload", .model = uploaded, .outcome = taken ? "allowed" : "denied"});
  if (!taken) ++context_->metrics.errors;
  keep_alive = keep_alive && outcome.whole && !context_->leaving;
  const AnswerForm form{version, keep_alive, /*head=*/false};
  const bool written = co_await connection_->write(outcome.answer, form);
  answering_ = false;
  const bool going_on = written && keep_alive && !context_->leaving;
  co_return going_on;
}

/// Passes the connection on when the request is for a WebSocket and there is nothing wrong with it.
bool HttpSession::become_websocket(const Parser::value_type& request) {
  const Result<HttpRoute> route = route_http(view_of(request.target()));
  if (!route || route->kind != HttpRoute::Kind::kWebSocket || !websocket::is_upgrade(request)) return false;
  if (context_->draining || connection_->buffer().size() > 0 || !refusal_of_guest().empty() ||
      !check_upgrade(upgrade_of(request), context_->config.allowed_origins)) {
    return false;
  }
  connection_->wait_without_limit();
  passed_on_ = true;
  auto transport = make_websocket_transport(std::move(connection_->stream()), request, context_->config.ping,
                                            context_->config.request_bytes);
  counted_guest_.reset();
  adopt_(start_message_session(std::move(transport), {context_, std::move(open_), asker_.session, refusal_, guest_}));
  return true;
}

/// Says what is wrong with a request for a WebSocket that was not granted.
HttpAnswer HttpSession::refuse_websocket(const Parser::value_type& request) const {
  if (!websocket::is_upgrade(request)) {
    HttpAnswer refusal = error_answer({ErrorKind::kUnsupported, "this path only accepts WebSocket connections"}, 426);
    refusal.headers = {{"Upgrade", "websocket"}, {"Sec-WebSocket-Version", "13"}};
    return refusal;
  }
  if (context_->draining) return error_answer({ErrorKind::kUnavailable, "the server is stopping"});
  const Status checked = check_upgrade(upgrade_of(request), context_->config.allowed_origins);
  if (!checked) return error_answer(checked.error(), checked.error().kind == ErrorKind::kUnsupported ? 400 : 403);
  return error_answer({ErrorKind::kInvalidInput, "nothing may be sent before the WebSocket is granted"}, 400);
}

/// Health is answered to those, too, who are not served: a full server that seems dead would be started again.
bool asks_for_health(const Result<HttpRoute>& route) {
  return route && (route->kind == HttpRoute::Kind::kHealth || route->kind == HttpRoute::Kind::kReady);
}

asio::awaitable<HttpAnswer> HttpSession::answer(const Parser::value_type& request) {
  const std::string_view target = view_of(request.target());
  Result<HttpRoute> route = route_http(target);
  if (!refusal_.empty() && !asks_for_health(route)) co_return error_answer({ErrorKind::kUnavailable, refusal_});
  if (!asks_for_health(route) && !context_->gate->admits(guest_)) co_return co_await deny(request);
  if (std::string busy = refusal_of_guest(); !busy.empty() && !asks_for_health(route)) {
    co_return error_answer({ErrorKind::kUnavailable, std::move(busy)}, 429);
  }
  const StaticFile* file = find_file(context_->config, target);
  if (!route && file == nullptr) co_return error_answer(route.error());
  if (is_upload(request)) co_return denied_answer();
  if (route && (route->kind == HttpRoute::Kind::kLogin || route->kind == HttpRoute::Kind::kLogout)) {
    HttpAnswer refusal = error_answer({ErrorKind::kUnsupported, "a token is sent here with POST"}, 405);
    refusal.headers.emplace_back("Allow", "POST");
    co_return refusal;
  }
  if (route && route->kind == HttpRoute::Kind::kUpload) {
    HttpAnswer refusal = error_answer({ErrorKind::kUnsupported, "scans are sent here with PUT"}, 405);
    refusal.headers.emplace_back("Allow", "PUT");
    co_return refusal;
  }
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    HttpAnswer refusal = error_answer({ErrorKind::kUnsupported, "only GET and HEAD are answered"}, 405);
    refusal.headers.emplace_back("Allow", "GET, HEAD");
    co_return refusal;
  }
  if (file != nullptr) co_return file_answer(*file, view_of(request[http::field::if_none_match]));
  if (route->kind == HttpRoute::Kind::kWebSocket) co_return refuse_websocket(request);
  audit_route(*route);
  route->accept = std::string(view_of(request[http::field::accept]));
  co_return co_await places_->answer(std::move(*route));
}

}  // namespace

std::shared_ptr<Session> start_http_session(Connection connection, AdoptSession adopt) {
  const service::Asker asker = connection.peer.asker();
  const auto session = std::make_shared<HttpSession>(std::move(connection), std::move(adopt), asker);
  session->start();
  return session;
}

}  // namespace surfcast::net
