#include "net/http_connection.h"

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <charconv>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "net/reading_rate.h"
#include "net/redirect_error_to.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

/// Bytes of a second request that are read before the rest of it. Not a setting: only how they are split depends on it.
constexpr size_t kFirstBytes = 1024;
/// Bytes of a body. Not a setting: only uploads have one, and they are read piece by piece.
constexpr uint64_t kBodyLimit = 4096;

using Body = http::span_body<const char>;

http::response<Body> response_of(const HttpAnswer& answer, const AnswerForm& form) {
  http::response<Body> response{static_cast<http::status>(answer.status), form.version};
  response.set(http::field::server, "surfcastd");
  response.set(http::field::content_type, answer.content_type);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Cross-Origin-Resource-Policy", "same-origin");  // pages of other sites cannot show or read it
  for (const auto& [name, value] : answer.headers) response.set(name, value);
  if (answer.more && form.version >= 11) response.chunked(true);
  if (!answer.more && answer.status != 304) response.content_length(answer.body.size());
  response.keep_alive(form.keep_alive && (!answer.more || form.version >= 11));
  if (!form.head) response.body() = {reinterpret_cast<const char*>(answer.body.data()), answer.body.size()};
  return response;
}

/// A piece of a body whose length is not known beforehand (RFC 9112, 7.1). HTTP/1.0 has no marks between pieces; there
/// the body ends with the connection.
Bytes chunk_of(const Bytes& piece, bool last, bool marked) {
  if (!marked) return piece;
  const auto add_text = [](Bytes& bytes, std::string_view text) {
    const auto added = std::as_bytes(std::span(text));
    bytes.insert(bytes.end(), added.begin(), added.end());
  };
  Bytes chunk;
  if (!piece.empty()) {
    std::array<char, 16> digits{};
    const char* end = std::to_chars(digits.data(), digits.data() + digits.size(), piece.size(), 16).ptr;
    add_text(chunk, {digits.data(), end});
    add_text(chunk, "\r\n");
    chunk.insert(chunk.end(), piece.begin(), piece.end());
    add_text(chunk, "\r\n");
  }
  if (last) add_text(chunk, "0\r\n\r\n");
  return chunk;
}

}  // namespace

HttpConnection::HttpConnection(ClientStream stream, const Bytes& begun, std::shared_ptr<const NetContext> context)
    : stream_(std::move(stream)),
      buffer_(context->config.http_header_bytes + kBodyLimit),
      context_(std::move(context)) {
  buffer_.commit(asio::buffer_copy(buffer_.prepare(begun.size()), asio::buffer(begun)));
}

/// A connection may be silent for long between two requests. Once a request has begun, it must be whole in time.
asio::awaitable<error_code> HttpConnection::read_head(HeadParser& parser) {
  error_code code;
  if (!first_ && buffer_.size() == 0) {
    stream_.socket().expires_after(context_->config.idle);
    const size_t count = co_await stream_.async_read_some(buffer_.prepare(kFirstBytes), redirect_error_to(code));
    buffer_.commit(count);
    if (code) co_return code;
  }
  first_ = false;
  stream_.socket().expires_after(context_->config.hello);
  co_await http::async_read_header(stream_, buffer_, parser, redirect_error_to(code));
  co_return code;
}

asio::awaitable<void> HttpConnection::say_continue(const HeadParser& head) {
  static constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
  if (!boost::beast::iequals(head.get()[http::field::expect], "100-continue")) co_return;
  stream_.socket().expires_after(context_->config.stall);
  error_code ignored;  // reading fails as well
  co_await asio::async_write(stream_, asio::buffer(kContinue), redirect_error_to(ignored));
}

asio::awaitable<std::optional<std::string>> HttpConnection::read_body(HeadParser& head, size_t most) {
  if (head.content_length().value_or(0) > most) co_return std::nullopt;
  co_await say_continue(head);
  http::request_parser<http::string_body> body{std::move(head)};
  body.body_limit(most);
  error_code code;
  stream_.socket().expires_after(context_->config.hello);
  co_await http::async_read(stream_, buffer_, body, redirect_error_to(code));
  if (code) co_return std::nullopt;
  co_return std::move(body.get().body());
}

asio::awaitable<bool> HttpConnection::write(const HttpAnswer& answer, const AnswerForm& form) {
  http::response<Body> response = response_of(answer, form);
  http::response_serializer<Body> serializer{response};
  serializer.split(static_cast<bool>(answer.more));  // the head alone, whose end would be that of the body
  const auto is_done = [&] { return answer.more ? serializer.is_header_done() : serializer.is_done(); };
  error_code code;
  const ServerConfig& config = context_->config;
  ReadingRate rate(config.stall, config.least_rate, ReadingRate::Clock::now());
  while (!is_done() && !code && !rate.is_too_slow(ReadingRate::Clock::now())) {
    stream_.socket().expires_after(config.stall);  // for some bytes, not for all of them
    const size_t taken = co_await http::async_write_some(stream_, serializer, redirect_error_to(code));
    rate.take(taken);
  }
  if (!is_done() || code) co_return false;
  if (!answer.more || form.head) co_return true;
  const bool whole = co_await write_more(answer, form);
  co_return whole;
}

/// The rest of the body. When it cannot be made the client learns that it is not whole: its end is missing.
asio::awaitable<bool> HttpConnection::write_more(const HttpAnswer& answer, const AnswerForm& form) {
  const bool marked = form.version >= 11;
  for (;;) {
    const Result<service::PointPiece> piece = co_await answer.more();
    if (!piece) co_return false;
    const Bytes chunk = chunk_of(piece->bytes, piece->last, marked);
    const bool written = co_await write_bytes(chunk);
    if (!written || piece->last) co_return written&& marked;
  }
}

asio::awaitable<bool> HttpConnection::write_bytes(const Bytes& bytes) {
  const ServerConfig& config = context_->config;
  ReadingRate rate(config.stall, config.least_rate, ReadingRate::Clock::now());
  error_code code;
  for (size_t sent = 0; sent < bytes.size() && !code;) {
    if (rate.is_too_slow(ReadingRate::Clock::now())) co_return false;
    stream_.socket().expires_after(config.stall);
    const size_t taken = co_await stream_.async_write_some(asio::buffer(bytes.data() + sent, bytes.size() - sent),
                                                           redirect_error_to(code));
    sent += taken;
    rate.take(taken);
  }
  co_return !code;
}

/// Closing with bytes of the client unread resets the connection, and the answer may be lost on its way.
asio::awaitable<void> HttpConnection::linger() {
  error_code ignored;
  stream_.socket().expires_after(std::min(context_->config.hello, context_->config.stall));
  if (stream_.is_encrypted()) co_await stream_.async_shutdown(redirect_error_to(ignored));
  stream_.socket().socket().shutdown(tcp::socket::shutdown_send, ignored);
  std::array<char, 4096> scratch{};
  while (!ignored && !context_->draining) {
    co_await stream_.async_read_beneath(asio::buffer(scratch), redirect_error_to(ignored));
  }
  stream_.socket().close();
}

asio::awaitable<error_code> HttpConnection::await_word() {
  error_code code;
  co_await stream_.socket().socket().async_wait(tcp::socket::wait_read, redirect_error_to(code));
  co_return code;
}

void HttpConnection::stop_awaiting() {
  error_code ignored;
  if (is_open()) stream_.socket().socket().cancel(ignored);
}

bool HttpConnection::has_left() {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (::getsockopt(stream_.socket().socket().native_handle(), IPPROTO_TCP, TCP_INFO, &info, &size) != 0) return true;
  return info.tcpi_state != TCP_ESTABLISHED;
}

}  // namespace surfcast::net
