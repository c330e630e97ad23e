#pragma once

#include <boost/asio/async_result.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <cstddef>
#include <memory>
#include <utility>

#include "tls/io_handler.h"

namespace surfcast::tls {

/// The bytes of a connection, as they are or through TLS. `Socket` is a TCP socket of Asio or Beast's stream of one.
/// Has the asynchronous operations that Asio and Beast expect of a stream.
template <typename Socket>
class Stream {
 public:
  using executor_type = typename Socket::executor_type;
  using Encryption = boost::asio::ssl::stream<Socket&>;
  using HandshakeType = boost::asio::ssl::stream_base::handshake_type;

  explicit Stream(Socket socket) : socket_(std::make_unique<Socket>(std::move(socket))) {}

  /// Everything from here on goes through TLS, beginning with async_handshake.
  void encrypt(boost::asio::ssl::context& context) { encryption_ = std::make_unique<Encryption>(*socket_, context); }
  /// Null: bytes travel as they are.
  [[nodiscard]] Encryption* encryption() { return encryption_.get(); }
  [[nodiscard]] bool is_encrypted() const { return encryption_ != nullptr; }
  /// Beneath TLS.
  [[nodiscard]] Socket& socket() { return *socket_; }
  [[nodiscard]] const Socket& socket() const { return *socket_; }
  [[nodiscard]] executor_type get_executor() { return socket_->get_executor(); }

  template <typename Buffers, typename Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return initiate<void(boost::system::error_code, size_t)>(
        token, [this, list = ReadBuffers(buffers)](IoHandler handler) { start_read(list, std::move(handler)); });
  }
  template <typename Buffers, typename Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return initiate<void(boost::system::error_code, size_t)>(
        token, [this, list = WriteBuffers(buffers)](IoHandler handler) { start_write(list, std::move(handler)); });
  }
  /// Of TLS; `encrypt` must have been called.
  template <typename Token>
  auto async_handshake(HandshakeType type, Token&& token) {
    return initiate<void(boost::system::error_code)>(
        token, [this, type](IoHandler handler) { start_handshake(type, std::move(handler)); });
  }
  template <typename Token>
  auto async_shutdown(Token&& token) {
    return initiate<void(boost::system::error_code)>(token,
                                                     [this](IoHandler handler) { start_shutdown(std::move(handler)); });
  }
  /// What arrives beneath TLS.
  template <typename Buffers, typename Token>
  auto async_read_beneath(const Buffers& buffers, Token&& token) {
    return initiate<void(boost::system::error_code, size_t)>(
        token,
        [this, list = ReadBuffers(buffers)](IoHandler handler) { start_read_beneath(list, std::move(handler)); });
  }

  // The same for a handler that is erased already. They are instantiated in stream.cpp alone.
  void start_read(const ReadBuffers& buffers, IoHandler handler);
  void start_write(const WriteBuffers& buffers, IoHandler handler);
  void start_handshake(HandshakeType type, IoHandler handler);
  void start_shutdown(IoHandler handler);
  void start_read_beneath(const ReadBuffers& buffers, IoHandler handler);
  /// Ends the connection of a WebSocket, which has said goodbye itself.
  void start_teardown(boost::beast::role_type role, IoHandler handler);

 private:
  template <typename Signature, typename Token, typename Start>
  auto initiate(Token& token, Start&& start) {
    return boost::asio::async_initiate<Token, Signature>(
        [this](auto handler, auto begin) { begin(IoHandler::erase<Signature>(std::move(handler), get_executor())); },
        token, std::forward<Start>(start));
  }

  std::unique_ptr<Socket> socket_;  // stays where it is when the stream moves
  std::unique_ptr<Encryption> encryption_;
};

extern template class Stream<boost::asio::ip::tcp::socket>;
extern template class Stream<boost::beast::tcp_stream>;

inline boost::asio::ip::tcp::socket& tcp_socket(boost::asio::ip::tcp::socket& socket) {
  return socket;
}
inline boost::asio::ip::tcp::socket& tcp_socket(boost::beast::tcp_stream& stream) {
  return stream.socket();
}

// Found by Beast: the end of a WebSocket is the end of the connection beneath it.
template <typename Socket, typename Handler>
void async_teardown(boost::beast::role_type role, Stream<Socket>& stream, Handler&& handler) {
  using Signature = void(boost::system::error_code);
  stream.start_teardown(
      role, IoHandler::erase<Signature>(std::decay_t<Handler>(std::forward<Handler>(handler)), stream.get_executor()));
}
template <typename Socket>
void beast_close_socket(Stream<Socket>& stream) {
  boost::system::error_code ignored;
  tcp_socket(stream.socket()).close(ignored);
}

}  // namespace surfcast::tls
