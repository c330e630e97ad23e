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
#include "net/http_route.h"
#include "net/http_routes.h"
#include "net/http_upload.h"
#include "net/redirect_error_to.h"
#include "net/request_guard.h"
#include "net/sessions.h"
#include "net/trace.h"
#include "net/transports.h"
#include "net/upgrade.h"
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

UpgradeRequest upgrade_of(const UpgradeHead& request, bool tls) {
  return {origin_of(request, tls), view_of(request[http::field::sec_websocket_protocol])};
}

RequestHead guarded_head_of(const HeadParser::value_type& request, bool tls) {
  return {.version = request.version(),
          .get = request.method() == http::verb::get || request.method() == http::verb::head,
          .hosts = request.count(http::field::host),
          .host = view_of(request[http::field::host]),
          .transfer_encodings = request.count(http::field::transfer_encoding),
          .transfer_encoding = view_of(request[http::field::transfer_encoding]),
          .content_length = request.count(http::field::content_length) > 0,
          .origin = view_of(request[http::field::origin]),
          .scheme = scheme_of(request, tls),
          .fetch_site = view_of(request["Sec-Fetch-Site"]),
          .fetch_mode = view_of(request["Sec-Fetch-Mode"]),
          .fetch_destination = view_of(request["Sec-Fetch-Dest"])};
}

HttpCredentials credentials_of(const HeadParser::value_type& request) {
  return {view_of(request[http::field::authorization]), view_of(request[http::field::cookie]),
          view_of(request[http::field::sec_websocket_protocol])};
}

HttpMethod method_of(http::verb verb) {
  if (verb == http::verb::get || verb == http::verb::head) return HttpMethod::kGet;
  if (verb == http::verb::put) return HttpMethod::kPut;
  return verb == http::verb::post ? HttpMethod::kPost : HttpMethod::kOther;
}

/// A request whose head was read.
struct HttpRequest {
  explicit HttpRequest(const HeadParser::value_type& read)
      : head(read),
        target(parse_target(view_of(read.target()))),
        sends(body_of(target.route, method_of(read.method()))) {}

  const HeadParser::value_type& head;
  HttpTarget target;
  SentBody sends;
};

/// As the audit log calls what is asked of a model.
std::string_view audited_name(ModelRoute::Resource resource) {
  switch (resource) {
    case ModelRoute::Resource::kDescription:
      return "describe";
    case ModelRoute::Resource::kPicture:
      return "picture";
    case ModelRoute::Resource::kPick:
      return "pick";
    case ModelRoute::Resource::kProfile:
      return "profile";
    case ModelRoute::Resource::kPoints:
      return "points";
    case ModelRoute::Resource::kAnnotations:
      break;
  }
  return "annotations";
}

class HttpSession : public Session, public std::enable_shared_from_this<HttpSession> {
 public:
  using Clock = std::chrono::steady_clock;

  HttpSession(Connection connection, AdoptSession adopt, const service::Client& client)
      : connection_(
            std::make_shared<HttpConnection>(std::move(connection.stream), connection.begun, connection.peer.context)),
        context_(std::move(connection.peer.context)),
        open_(std::move(connection.peer.open)),
        client_(client),
        refusal_(std::move(connection.peer.refusal)),
        adopt_(std::move(adopt)),
        routes_(std::make_shared<HttpRoutes>(context_, connection_, client_)) {}

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
    if (!routes_->cancel()) abort();
  }
  [[nodiscard]] bool refused() const override { return !refusal_.empty() && !aborted_; }
  [[nodiscard]] std::optional<Clock::time_point> idle_since() const override {
    const bool waits = !answering_ && !passed_on_ && !aborted_ && refusal_.empty();
    return waits ? std::optional(idle_since_) : std::nullopt;
  }
  [[nodiscard]] std::string client() const override { return open_.client(); }
  void abort() override {
    aborted_ = true;
    routes_->cancel();
    if (!passed_on_) connection_->close();
  }
  /// Ends a request that is being answered, or a scan that is being received, with its token.
  void check_user() override {
    if (!user_ || !answering_ || passed_on_ || aborted_) return;
    const std::string reason = context_->gate->why_ended(user_);
    if (reason.empty()) return;
    audit({.what = "token", .outcome = "denied", .reason = reason});
    abort();
  }

 private:
  using Parser = HeadParser;

  asio::awaitable<void> serve();
  asio::awaitable<bool> serve_one();
  [[nodiscard]] std::optional<HttpAnswer> refusal_of_head(const Parser& parser, const error_code& code,
                                                          SentBody body) const;
  asio::awaitable<bool> serve_upload(Parser& parser, const access::AuthorizedUpload& upload);
  asio::awaitable<bool> serve_login(Parser& parser, const HttpRequest& request);
  asio::awaitable<bool> serve_annotations(Parser& parser, const HttpRequest& request);
  asio::awaitable<HttpAnswer> answer_annotation_write(Parser& parser, const HttpRequest& request);
  asio::awaitable<HttpAnswer> answer_login(Parser& parser, const HttpRequest& request);
  void identify(const Parser::value_type& head);
  [[nodiscard]] std::optional<access::AuthorizedUpload> authorize_upload(const std::string& file) const;
  [[nodiscard]] std::string refusal_of_user() const;
  asio::awaitable<void> wait_for_penalty();
  asio::awaitable<HttpAnswer> deny(const HttpRequest& request);
  asio::awaitable<HttpAnswer> answer(const HttpRequest& request);
  void audit(AuditEvent event) const;
  bool become_websocket(const HttpRequest& request);
  [[nodiscard]] HttpAnswer refuse_websocket(const Parser::value_type& head) const;

  std::shared_ptr<HttpConnection> connection_;
  std::shared_ptr<NetContext> context_;
  Counted open_;
  service::Client client_;
  std::string refusal_;  ///< as in Peer
  AdoptSession adopt_;
  bool answering_ = false;
  bool aborted_ = false;
  bool passed_on_ = false;  ///< the connection is a WebSocket's
  std::shared_ptr<HttpRoutes> routes_;
  Clock::time_point idle_since_ = Clock::now();  ///< while no request is answered
  Gatekeeper::User user_;                        ///< of the request that is answered
  std::optional<Counted> counted_user_;
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
std::optional<HttpAnswer> HttpSession::refusal_of_head(const Parser& parser, const error_code& code,
                                                       SentBody body) const {
  if (code) {
    return error_answer({ErrorKind::kInvalidInput, "not a request of HTTP/1.1: " + code.message()}, status_of(code));
  }
  const ServerConfig& config = context_->config;
  const auto refusal =
      refusal_of(guarded_head_of(parser.get(), connection_->tls()), {config.hosts, config.allowed_origins});
  if (refusal) return error_answer(refusal->error, refusal->status);
  if (parser.is_done() || (refusal_.empty() && body != SentBody::kNone)) return std::nullopt;
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
  const Parser::value_type& head = parser.get();
  const HttpRequest request(head);
  const std::optional<HttpAnswer> refused = refusal_of_head(parser, code, request.sends);
  if (!refused) identify(head);
  if (!refused && parser.is_done() && become_websocket(request)) co_return false;
  answering_ = true;
  const SentBody sends = !refused && refusal_.empty() ? request.sends : SentBody::kNone;
  if (sends == SentBody::kLogin) co_return co_await serve_login(parser, request);
  if (sends == SentBody::kAnnotations) co_return co_await serve_annotations(parser, request);
  if (sends == SentBody::kScan) {
    const auto upload = authorize_upload(std::get<UploadRoute>(*request.target.route).file);
    if (upload) co_return co_await serve_upload(parser, *upload);
  }
  HttpAnswer result;
  if (refused) {
    result = *refused;
  } else {
    result = co_await answer(request);
  }
  if (result.status >= 400) ++context_->metrics.errors;
  std::string trace = answered_trace(view_of(head["traceparent"]));
  if (!trace.empty()) result.headers.emplace_back("traceparent", std::move(trace));
  const bool keep_alive = !refused && parser.is_done() && head.keep_alive() && !context_->leaving && refusal_.empty();
  const bool without_body = !code && head.method() == http::verb::head;
  const AnswerForm form{code ? 11 : head.version(), keep_alive, without_body};
  const bool written = co_await connection_->write(result, form);
  answering_ = false;
  // The server may have begun to stop during the write.
  const bool going_on = written && keep_alive && !context_->leaving;
  co_return going_on;
}

/// Finds out who asks. Turns of the renderer go to a user, on whatever connections it comes.
void HttpSession::identify(const Parser::value_type& head) {
  const std::string_view token = token_of(credentials_of(head));
  user_ = token.empty() ? nullptr : context_->gate->enter(token, open_.client());
  const bool wrong = !token.empty() && !user_ && context_->gate->wants_tokens();
  if (wrong) audit({.what = "token", .outcome = "denied"});
  routes_->set_user(context_->gate->rights(user_), {client_id(open_.client(), user_), client_.session});
  const bool same = user_ && counted_user_ && counted_user_->client() == user_->name;
  if (same) return;
  counted_user_.reset();
  if (!user_ || !refusal_of_user().empty()) return;
  counted_user_ = context_->gate->count(user_, &Clients::Counts::connections);
  audit({.what = "token", .outcome = "allowed"});
}

/// Adds who it is and where from.
void HttpSession::audit(AuditEvent event) const {
  if (!context_->audit) return;
  event.client = open_.client();
  event.connection = client_.session;
  if (user_) event.who = user_->name;
  context_->audit->write(event);
}

/// Why a user who may come in has to wait; empty: it has not.
std::string HttpSession::refusal_of_user() const {
  return counted_user_ ? std::string() : context_->gate->refusal_of_connection(user_);
}

/// Nothing if whoever begins to send a scan may not, or not under that name.
std::optional<access::AuthorizedUpload> HttpSession::authorize_upload(const std::string& file) const {
  if (!refusal_of_user().empty()) return std::nullopt;
  return context_->gate->rights(user_).authorize_upload(file, service::model_name(file));
}

asio::awaitable<void> HttpSession::wait_for_penalty() {
  error_code ignored;
  connection_->wait_without_limit();
  asio::steady_timer penalty(connection_->stream().get_executor(), context_->gate->penalty(open_.client()));
  co_await penalty.async_wait(redirect_error_to(ignored));
}

/// The answer to somebody who may not ask. A browser gets a page to log in.
asio::awaitable<HttpAnswer> HttpSession::deny(const HttpRequest& request) {
  co_await wait_for_penalty();
  const bool page = leads_to(request.target.route, ServerRoute::kPage) && request.head.method() == http::verb::get;
  co_return page ? login_page("") : denied_answer();
}

asio::awaitable<HttpAnswer> HttpSession::answer_login(Parser& parser, const HttpRequest& request) {
  constexpr size_t kMaxBytes = 1024;  // of the form
  const RequestOrigin origin = origin_of(parser.get(), connection_->tls());
  const bool encrypted = origin.scheme == "https";
  const Status page = check_origin(origin, context_->config.allowed_origins);
  if (!page) co_return error_answer(page.error(), 403);
  const bool logout = leads_to(request.target.route, ServerRoute::kLogout);
  const std::optional<std::string> form = co_await connection_->read_body(parser, kMaxBytes);
  if (!form) co_return error_answer({ErrorKind::kInvalidInput, "this is no form with a token"}, 400);
  if (logout) co_return login_answer(login_cookie("", encrypted));
  const std::string token = token_of_form(*form);
  const Gatekeeper::User user = context_->gate->enter(token, open_.client());
  audit({.what = "login", .who = user ? user->name : "", .outcome = user ? "allowed" : "denied"});
  if (user) co_return login_answer(login_cookie(token, encrypted));
  co_await wait_for_penalty();
  co_return login_page("This token is not known here, or has ended.");
}

/// False: the connection ends. A browser opens another.
asio::awaitable<bool> HttpSession::serve_login(Parser& parser, const HttpRequest& request) {
  const AnswerForm form{parser.get().version(), /*keep_alive=*/false, /*head=*/false};
  const HttpAnswer result = co_await answer_login(parser, request);
  co_await connection_->write(result, form);
  answering_ = false;
  co_return false;
}

asio::awaitable<HttpAnswer> HttpSession::answer_annotation_write(Parser& parser, const HttpRequest& request) {
  if (!context_->gate->admits(user_)) co_return co_await deny(request);
  if (const std::string busy = refusal_of_user(); !busy.empty()) {
    const Error error{ErrorKind::kUnavailable, busy};
    co_return error_answer(error, 429);
  }
  const std::string& model = std::get<ModelRoute>(*request.target.route).model;
  const auto annotations = context_->gate->rights(user_).authorize_annotations(model);
  HttpAnswer result = forbidden_answer();
  if (annotations) {
    result = co_await receive_annotations(*context_, *connection_, parser, *annotations, client_.id);
  }
  audit({.what = "annotate", .model = model, .outcome = result.status < 400 ? "allowed" : "denied"});
  co_return result;
}

/// False: the connection ends.
asio::awaitable<bool> HttpSession::serve_annotations(Parser& parser, const HttpRequest& request) {
  const unsigned version = parser.get().version();
  const HttpAnswer result = co_await answer_annotation_write(parser, request);
  if (result.status >= 400) ++context_->metrics.errors;
  const AnswerForm form{version, /*keep_alive=*/false, /*head=*/false};
  co_await connection_->write(result, form);
  answering_ = false;
  co_return false;
}

/// Receives a scan and answers. False when the connection is at its end.
asio::awaitable<bool> HttpSession::serve_upload(Parser& parser, const access::AuthorizedUpload& upload) {
  const unsigned version = parser.get().version();
  bool keep_alive = parser.keep_alive();
  const UploadOutcome outcome = co_await receive_scan(*context_, *connection_, parser, upload);
  const bool taken = outcome.answer.status < 400;
  audit({.what = "upload", .model = upload.file(), .outcome = taken ? "allowed" : "denied"});
  if (!taken) ++context_->metrics.errors;
  keep_alive = keep_alive && outcome.whole && !context_->leaving;
  const AnswerForm form{version, keep_alive, /*head=*/false};
  const bool written = co_await connection_->write(outcome.answer, form);
  answering_ = false;
  const bool going_on = written && keep_alive && !context_->leaving;
  co_return going_on;
}

/// Passes the connection on when the request is for a WebSocket and there is nothing wrong with it.
bool HttpSession::become_websocket(const HttpRequest& request) {
  const Parser::value_type& head = request.head;
  if (!leads_to(request.target.route, ServerRoute::kWebSocket) || !websocket::is_upgrade(head)) return false;
  if (context_->draining || connection_->buffer().size() > 0 || !refusal_of_user().empty() ||
      !check_upgrade(upgrade_of(head, connection_->tls()), context_->config.allowed_origins)) {
    return false;
  }
  connection_->wait_without_limit();
  passed_on_ = true;
  auto transport = make_websocket_transport(std::move(connection_->stream()), head, context_->config.ping,
                                            context_->config.request_bytes);
  counted_user_.reset();
  adopt_(start_message_session(std::move(transport), {context_, std::move(open_), client_.session, refusal_, user_}));
  return true;
}

/// Says what is wrong with a request for a WebSocket that was not granted.
HttpAnswer HttpSession::refuse_websocket(const Parser::value_type& head) const {
  if (!websocket::is_upgrade(head)) {
    HttpAnswer refusal = error_answer({ErrorKind::kUnsupported, "this path only accepts WebSocket connections"}, 426);
    refusal.headers = {{"Upgrade", "websocket"}, {"Sec-WebSocket-Version", "13"}};
    return refusal;
  }
  if (context_->draining) return error_answer({ErrorKind::kUnavailable, "the server is stopping"});
  const Status checked = check_upgrade(upgrade_of(head, connection_->tls()), context_->config.allowed_origins);
  if (!checked) return error_answer(checked.error(), checked.error().kind == ErrorKind::kUnsupported ? 400 : 403);
  return error_answer({ErrorKind::kInvalidInput, "nothing may be sent before the WebSocket is granted"}, 400);
}

/// Health is answered to those, too, who are not served: a full server that seems dead would be started again.
bool asks_for_health(const Result<HttpRoute>& route) {
  return leads_to(route, ServerRoute::kHealth) || leads_to(route, ServerRoute::kReady);
}

HttpAnswer wrong_method(const char* problem, const char* allowed) {
  HttpAnswer refusal = error_answer({ErrorKind::kUnsupported, problem}, 405);
  refusal.headers.emplace_back("Allow", allowed);
  return refusal;
}

/// Those who may send something were answered before.
std::optional<HttpAnswer> refusal_of_method(const HttpRequest& request) {
  const Result<HttpRoute>& route = request.target.route;
  if (request.sends == SentBody::kScan) return denied_answer();
  if (leads_to(route, ServerRoute::kLogin) || leads_to(route, ServerRoute::kLogout)) {
    return wrong_method("a token is sent here with POST", "POST");
  }
  if (route && std::holds_alternative<UploadRoute>(*route)) return wrong_method("scans are sent here with PUT", "PUT");
  if (method_of(request.head.method()) == HttpMethod::kGet) return std::nullopt;
  return wrong_method("only GET and HEAD are answered", "GET, HEAD");
}

asio::awaitable<HttpAnswer> HttpSession::answer(const HttpRequest& request) {
  const Result<HttpRoute>& route = request.target.route;
  if (!refusal_.empty() && !asks_for_health(route)) co_return error_answer({ErrorKind::kUnavailable, refusal_});
  if (!asks_for_health(route) && !context_->gate->admits(user_)) co_return co_await deny(request);
  if (std::string busy = refusal_of_user(); !busy.empty() && !asks_for_health(route)) {
    co_return error_answer({ErrorKind::kUnavailable, std::move(busy)}, 429);
  }
  const StaticFile* file = context_->config.viewer ? context_->config.viewer->find(request.target.path) : nullptr;
  if (!route && file == nullptr) co_return error_answer(route.error());
  if (std::optional<HttpAnswer> refusal = refusal_of_method(request)) co_return std::move(*refusal);
  if (file != nullptr) co_return file_answer(*file, view_of(request.head[http::field::if_none_match]));
  if (leads_to(route, ServerRoute::kWebSocket)) co_return refuse_websocket(request.head);
  if (const ServerRoute* const of_server = std::get_if<ServerRoute>(&*route)) {
    const std::string accept(view_of(request.head[http::field::accept]));
    co_return co_await routes_->answer(*of_server, accept);
  }
  const ModelRoute& of_model = std::get<ModelRoute>(*route);
  const access::AuthorizedModel model = context_->gate->rights(user_).authorize(of_model.model);
  audit(question_about(model, audited_name(of_model.resource)));
  co_return co_await routes_->answer(of_model, model);
}

}  // namespace

std::shared_ptr<Session> start_http_session(Connection connection, AdoptSession adopt) {
  const service::Client client = connection.peer.client();
  const auto session = std::make_shared<HttpSession>(std::move(connection), std::move(adopt), client);
  session->start();
  return session;
}

}  // namespace surfcast::net
