#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <memory>
#include <optional>
#include <string>

#include "net/answers.h"
#include "net/connection.h"
#include "net/http_answer.h"
#include "net/http_upload.h"
#include "net/session.h"

namespace surfcast::net {

/// How an answer is written.
struct AnswerForm {
  unsigned version = 11;  ///< 10: HTTP/1.0
  bool keep_alive = true;
  bool head = false;  ///< without its body
};

/// Heads of requests and whole answers of HTTP over one connection, each within its time.
class HttpConnection {
 public:
  /// `begun`: bytes that were read of the first request.
  HttpConnection(ClientStream stream, const Bytes& begun, std::shared_ptr<const NetContext> context);

  /// Reads the head of the next request.
  boost::asio::awaitable<boost::system::error_code> read_head(HeadParser& parser);
  /// Tells a client that waits for it to send the body of the request whose head was read.
  boost::asio::awaitable<void> say_continue(const HeadParser& head);
  /// Reads the body of the request whose head was read; nothing if it is longer than that, or does not arrive.
  boost::asio::awaitable<std::optional<std::string>> read_body(HeadParser& head, size_t most);
  /// False when the client does not take the answer, or too slowly.
  boost::asio::awaitable<bool> write(const HttpAnswer& answer, const AnswerForm& form);
  /// Lets the client read the last words, then closes.
  boost::asio::awaitable<void> linger();

  /// What happens next may take as long as it likes.
  void wait_without_limit() { stream_.socket().expires_never(); }
  /// Returns at the end of the stream, or when the client has sent something.
  boost::asio::awaitable<boost::system::error_code> await_word();
  /// Ends `await_word` with an error.
  void stop_awaiting();
  /// Whether the client has closed the connection, or its side of it.
  [[nodiscard]] bool has_left();
  /// Whether TLS carries the connection.
  [[nodiscard]] bool tls() const { return stream_.is_encrypted(); }
  [[nodiscard]] bool is_open() const { return stream_.socket().socket().is_open(); }
  void close() { stream_.socket().close(); }

  [[nodiscard]] ClientStream& stream() { return stream_; }
  /// Bytes beyond the head of the last request.
  [[nodiscard]] boost::beast::flat_buffer& buffer() { return buffer_; }

 private:
  boost::asio::awaitable<bool> write_more(const HttpAnswer& answer, const AnswerForm& form);
  boost::asio::awaitable<bool> write_bytes(const Bytes& bytes);

  ClientStream stream_;
  boost::beast::flat_buffer buffer_;
  std::shared_ptr<const NetContext> context_;
  bool first_ = true;
};

}  // namespace surfcast::net
