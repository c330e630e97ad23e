#include "net/http_session.h"

#include <algorithm>
#include <array>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <utility>

#include "net/await_answer.h"
#include "net/convert.h"
#include "net/http_answer.h"
#include "net/http_route.h"
#include "net/http_upload.h"
#include "net/message_session.h"
#include "net/redirect_error_to.h"
#include "net/upgrade.h"
#include "net/websocket_transport.h"
#include "protocol/picture_query.h"
#include "protocol/profile_query.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

/// Bytes of a body. Not a setting: only uploads have one, and they are read piece by piece.
constexpr uint64_t kBodyLimit = 4096;

unsigned status_of(const error_code& code) {
  if (code == http::error::header_limit) return 431;
  return code == http::error::body_limit ? 413 : 400;
}

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

UpgradeRequest upgrade_of(const UpgradeHead& request) {
  return {view_of(request[http::field::host]), view_of(request[http::field::origin]),
          view_of(request[http::field::sec_websocket_protocol])};
}

/// The file of the viewer that a target names, query left out.
const StaticFile* find_file(const ServerConfig& config, std::string_view target) {
  return config.viewer ? config.viewer->find(target.substr(0, target.find('?'))) : nullptr;
}

class HttpSession : public Session, public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(Connection connection, AdoptSession adopt)
      : stream_(std::move(connection.socket)),
        buffer_(connection.peer.context->config.http_header_bytes + kBodyLimit),
        context_(std::move(connection.peer.context)),
        open_(std::move(connection.peer.open)),
        id_(connection.peer.id),
        refusal_(std::move(connection.peer.refusal)),
        adopt_(std::move(adopt)) {}

  void start() {
    asio::co_spawn(
        stream_.get_executor(),
        [](std::shared_ptr<HttpSession> self) -> asio::awaitable<void> { co_await self->serve(); }(shared_from_this()),
        asio::detached);
  }
  void drain() override {
    if (!answering_) abort();
  }
  void abort() override {
    if (job_) context_->service.cancel(*job_);
    stream_.close();
  }

 private:
  using Parser = HeadParser;

  asio::awaitable<void> serve();
  asio::awaitable<void> linger();
  asio::awaitable<bool> serve_one();
  asio::awaitable<bool> serve_upload(Parser& parser);
  asio::awaitable<HttpAnswer> answer(const Parser::value_type& request);
  bool become_websocket(const Parser::value_type& request);
  [[nodiscard]] HttpAnswer refuse_websocket(const Parser::value_type& request) const;
  [[nodiscard]] std::string metrics_text() const;
  asio::awaitable<HttpAnswer> answer_place(HttpRoute route);
  asio::awaitable<HttpAnswer> answer_about_model(HttpRoute route);
  asio::awaitable<HttpAnswer> answer_model(std::string name);
  asio::awaitable<HttpAnswer> answer_picture(HttpRoute route);
  asio::awaitable<HttpAnswer> answer_pick(HttpRoute route);
  asio::awaitable<HttpAnswer> answer_profile(HttpRoute route);
  asio::awaitable<HttpAnswer> answer_models();
  asio::awaitable<Result<service::EncodedPicture>> draw(service::PictureJob job);
  asio::awaitable<void> cancel_when_client_leaves(service::JobId job);
  asio::awaitable<bool> write(const HttpAnswer& answer, unsigned version, bool keep_alive, bool head);

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::shared_ptr<NetContext> context_;
  Counted open_;
  service::SessionId id_;
  std::string refusal_;  ///< as in Peer
  AdoptSession adopt_;
  bool answering_ = false;
  bool first_ = true;
  std::optional<service::JobId> job_;  ///< being drawn for this client
};

asio::awaitable<void> HttpSession::serve() {
  bool going_on = true;
  while (going_on) {
    going_on = co_await serve_one();
  }
  if (stream_.socket().is_open()) co_await linger();
}

/// Closing with bytes of the client unread resets the connection, and the answer may be lost on its way.
asio::awaitable<void> HttpSession::linger() {
  error_code ignored;
  stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  stream_.expires_after(std::min(context_->config.hello, context_->config.stall));
  std::array<char, 4096> scratch{};
  while (!ignored && !context_->draining) {
    co_await stream_.async_read_some(asio::buffer(scratch), redirect_error_to(ignored));
  }
  stream_.close();
}

/// Reads one request and answers it. False when the connection is at its end.
asio::awaitable<bool> HttpSession::serve_one() {
  error_code code;
  Parser parser;
  parser.header_limit(context_->config.http_header_bytes);
  parser.body_limit(boost::none);  // what is no upload is refused before its body is read
  stream_.expires_after(first_ ? context_->config.hello : context_->config.idle);
  first_ = false;
  co_await http::async_read_header(stream_, buffer_, parser, redirect_error_to(code));
  if (code == http::error::end_of_stream || !stream_.socket().is_open()) co_return false;
  if (code && code.category() != http::make_error_code(http::error::bad_method).category()) co_return false;
  ++context_->metrics.requests;
  const Parser::value_type& request = parser.get();
  if (!code && parser.is_done() && become_websocket(request)) co_return false;
  answering_ = true;
  if (!code && refusal_.empty() && is_upload(request)) co_return co_await serve_upload(parser);
  HttpAnswer result;
  if (code) {
    result = error_answer({ErrorKind::kInvalidInput, "not a request of HTTP/1.1: " + code.message()}, status_of(code));
  } else if (!parser.is_done()) {
    result = error_answer({ErrorKind::kLimit, "a request with a body is not wanted here"}, 413);
  } else {
    result = co_await answer(request);
  }
  if (result.status >= 400) ++context_->metrics.errors;
  const bool keep_alive = !code && parser.is_done() && request.keep_alive() && !context_->draining && refusal_.empty();
  const bool head = !code && request.method() == http::verb::head;
  const bool written = co_await write(result, code ? 11 : request.version(), keep_alive, head);
  answering_ = false;
  // The server may have begun to stop during the write.
  const bool going_on = written && keep_alive && !context_->draining;
  co_return going_on;
}

/// Receives a scan and answers. False when the connection is at its end.
asio::awaitable<bool> HttpSession::serve_upload(Parser& parser) {
  const unsigned version = parser.get().version();
  bool keep_alive = parser.keep_alive();
  const UploadOutcome outcome = co_await receive_scan(*context_, stream_, buffer_, parser);
  if (outcome.answer.status >= 400) ++context_->metrics.errors;
  keep_alive = keep_alive && outcome.whole && !context_->draining;
  const bool written = co_await write(outcome.answer, version, keep_alive, /*head=*/false);
  answering_ = false;
  const bool going_on = written && keep_alive && !context_->draining;
  co_return going_on;
}

/// Passes the connection on when the request is for a WebSocket and there is nothing wrong with it.
bool HttpSession::become_websocket(const Parser::value_type& request) {
  const Result<HttpRoute> route = route_http(view_of(request.target()));
  if (!route || route->kind != HttpRoute::Kind::kWebSocket || !websocket::is_upgrade(request)) return false;
  if (context_->draining || buffer_.size() > 0 ||
      !check_upgrade(upgrade_of(request), context_->config.allowed_origins)) {
    return false;
  }
  stream_.expires_never();
  auto transport = make_websocket_transport(stream_.release_socket(), request, context_->config.ping,
                                            context_->config.request_bytes);
  adopt_(start_message_session(std::move(transport), {context_, std::move(open_), id_, refusal_}));
  return true;
}

/// Says what is wrong with a request for a WebSocket that was not granted.
HttpAnswer HttpSession::refuse_websocket(const Parser::value_type& request) const {
  if (!websocket::is_upgrade(request)) {
    HttpAnswer refusal = error_answer({ErrorKind::kUnsupported, "this is the place of a WebSocket"}, 426);
    refusal.headers = {{"Upgrade", "websocket"}, {"Sec-WebSocket-Version", "13"}};
    return refusal;
  }
  if (context_->draining) return error_answer({ErrorKind::kUnavailable, "the server is stopping"});
  const Status checked = check_upgrade(upgrade_of(request), context_->config.allowed_origins);
  if (!checked) return error_answer(checked.error(), checked.error().kind == ErrorKind::kUnsupported ? 400 : 403);
  return error_answer({ErrorKind::kInvalidInput, "nothing may be sent before the WebSocket is granted"}, 400);
}

asio::awaitable<HttpAnswer> HttpSession::answer(const Parser::value_type& request) {
  if (!refusal_.empty()) co_return error_answer({ErrorKind::kUnavailable, refusal_});
  const std::string_view target = view_of(request.target());
  const StaticFile* file = find_file(context_->config, target);
  Result<HttpRoute> route = route_http(target);
  if (!route && file == nullptr) co_return error_answer(route.error());
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
  co_return co_await answer_place(std::move(*route));
}

asio::awaitable<HttpAnswer> HttpSession::answer_place(HttpRoute route) {
  switch (route.kind) {
    case HttpRoute::Kind::kPage:
      co_return no_viewer_answer();
    case HttpRoute::Kind::kModels:
      co_return co_await answer_models();
    case HttpRoute::Kind::kModel:
    case HttpRoute::Kind::kPicture:
    case HttpRoute::Kind::kPick:
    case HttpRoute::Kind::kProfile:
      co_return co_await answer_about_model(std::move(route));
    case HttpRoute::Kind::kHealth:
      co_return text_answer("ok\n", "text/plain");
    case HttpRoute::Kind::kReady:
      if (context_->draining) co_return error_answer({ErrorKind::kUnavailable, "the server is stopping"});
      co_return text_answer("ready\n", "text/plain");
    case HttpRoute::Kind::kMetrics:
    case HttpRoute::Kind::kUpload:     // answered already
    case HttpRoute::Kind::kWebSocket:  // answered already
      break;
  }
  co_return text_answer(metrics_text(), "text/plain; version=0.0.4");
}

/// What is asked of one model.
asio::awaitable<HttpAnswer> HttpSession::answer_about_model(HttpRoute route) {
  switch (route.kind) {
    case HttpRoute::Kind::kPicture:
      return answer_picture(std::move(route));
    case HttpRoute::Kind::kPick:
      return answer_pick(std::move(route));
    case HttpRoute::Kind::kProfile:
      return answer_profile(std::move(route));
    default:
      return answer_model(std::move(route.model));
  }
}

std::string HttpSession::metrics_text() const {
  const Clients::Counts& open = context_->clients->all();
  return to_prometheus(context_->metrics, {.connections = open.connections + open.refused,
                                           .queued = context_->service.queued(),
                                           .memory = context_->service.device().memory});
}

asio::awaitable<HttpAnswer> HttpSession::answer_models() {
  const auto models =
      co_await answer_of<service::ModelList>([this](auto done) { context_->service.list_models(std::move(done)); });
  co_return models_answer(models, context_->config.uploads);
}

asio::awaitable<HttpAnswer> HttpSession::answer_model(std::string name) {
  const auto description = co_await answer_of<Result<service::ModelDescription>>(
      [&](auto done) { context_->service.describe_model(name, std::move(done)); });
  co_return description ? model_answer(name, *description) : error_answer(description.error());
}

asio::awaitable<HttpAnswer> HttpSession::answer_pick(HttpRoute route) {
  const Result<service::PickJob> job =
      protocol::parse_pick_query(route.model, route.query).and_then([](const wire::PickSurfel& request) {
        return to_job(request);
      });
  if (!job) co_return error_answer(job.error());
  const auto picked = co_await answer_of<Result<std::optional<kinds::PickedSurfel>>>(
      [&](auto done) { context_->service.pick(*job, std::move(done)); });
  co_return picked ? pick_answer(*picked) : error_answer(picked.error());
}

asio::awaitable<HttpAnswer> HttpSession::answer_profile(HttpRoute route) {
  const Result<protocol::ProfileQuery> query = protocol::parse_profile_query(route.model, route.query);
  if (!query) co_return error_answer(query.error());
  const Result<service::ProfileJob> job = to_job(query->profile);
  if (!job) co_return error_answer(job.error());
  stream_.expires_never();
  const auto profile = co_await answer_of<Result<service::ProfileResult>>(
      [&](auto done) { context_->service.profile(*job, std::move(done)); });
  co_return profile ? profile_answer(route.model, *profile, query->format) : error_answer(profile.error());
}

asio::awaitable<HttpAnswer> HttpSession::answer_picture(HttpRoute route) {
  Result<service::PictureJob> job =
      protocol::parse_picture_query(route.model, route.query).and_then([](const wire::DrawPicture& request) {
        return to_job(request);
      });
  if (!job) co_return error_answer(job.error());
  Result<service::EncodedPicture> picture = co_await draw(std::move(*job));
  if (!picture) co_return error_answer(picture.error());
  context_->metrics.count_picture(picture->bytes.size(), picture->stats);
  co_return picture_answer(std::move(*picture));
}

asio::awaitable<Result<service::EncodedPicture>> HttpSession::draw(service::PictureJob job) {
  stream_.expires_never();
  Result<service::EncodedPicture> picture = co_await answer_of<Result<service::EncodedPicture>>([&](auto done) {
    job_ = context_->service.draw(id_, std::move(job), std::move(done));
    asio::co_spawn(
        stream_.get_executor(),
        [](std::shared_ptr<HttpSession> self, service::JobId id) -> asio::awaitable<void> {
          co_await self->cancel_when_client_leaves(id);
        }(shared_from_this(), *job_),
        asio::detached);
  });
  job_.reset();
  error_code ignored;
  if (stream_.socket().is_open()) stream_.socket().cancel(ignored);  // the watch for the client's leaving
  co_return picture;
}

/// Looks at what arrives while a picture is drawn: the end of the stream means that nobody waits for it any more.
asio::awaitable<void> HttpSession::cancel_when_client_leaves(service::JobId job) {
  error_code code;
  co_await stream_.socket().async_wait(tcp::socket::wait_read, redirect_error_to(code));
  if (code || job_ != job) co_return;
  char byte = 0;
  stream_.socket().non_blocking(true, code);
  const size_t count = stream_.socket().receive(asio::buffer(&byte, 1), tcp::socket::message_peek, code);
  if (count == 0 && code != asio::error::would_block) context_->service.cancel(job);
}

asio::awaitable<bool> HttpSession::write(const HttpAnswer& answer, unsigned version, bool keep_alive, bool head) {
  using Body = http::span_body<const char>;
  http::response<Body> response{static_cast<http::status>(answer.status), version};
  response.set(http::field::server, "surfcastd");
  response.set(http::field::content_type, answer.content_type);
  response.set("X-Content-Type-Options", "nosniff");
  for (const auto& [name, value] : answer.headers) response.set(name, value);
  if (answer.status != 304) response.content_length(answer.body.size());
  response.keep_alive(keep_alive);
  if (!head) response.body() = {reinterpret_cast<const char*>(answer.body.data()), answer.body.size()};
  http::response_serializer<Body> serializer{response};
  error_code code;
  while (!serializer.is_done() && !code) {
    stream_.expires_after(context_->config.stall);  // for some bytes, not for all of them
    co_await http::async_write_some(stream_, serializer, redirect_error_to(code));
  }
  co_return !code;
}

}  // namespace

std::shared_ptr<Session> start_http_session(Connection connection, AdoptSession adopt) {
  const auto session = std::make_shared<HttpSession>(std::move(connection), std::move(adopt));
  session->start();
  return session;
}

}  // namespace surfcast::net
