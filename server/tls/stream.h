#pragma once

#include <boost/asio/async_result.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <cstddef>
#include <memory>
#include <utility>

namespace surfcast::tls {

/// The bytes of a connection, as they are or through TLS. `Socket` is a TCP socket of Asio or a stream of Beast. Has
/// the asynchronous operations that Asio and Beast expect of a stream.
template <typename Socket>
class Stream {
 public:
  using executor_type = typename Socket::executor_type;
  using Encryption = boost::asio::ssl::stream<Socket&>;

  explicit Stream(Socket socket) : socket_(std::make_unique<Socket>(std::move(socket))) {}

  /// Everything from here on goes through TLS. The handshake is the caller's, on `encryption()`.
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
    const auto initiate = [this](auto handler, const Buffers& target) {
      if (encryption_) return encryption_->async_read_some(target, std::move(handler));
      socket_->async_read_some(target, std::move(handler));
    };
    return boost::asio::async_initiate<Token, void(boost::system::error_code, size_t)>(initiate, token, buffers);
  }
  template <typename Buffers, typename Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    const auto initiate = [this](auto handler, const Buffers& source) {
      if (encryption_) return encryption_->async_write_some(source, std::move(handler));
      socket_->async_write_some(source, std::move(handler));
    };
    return boost::asio::async_initiate<Token, void(boost::system::error_code, size_t)>(initiate, token, buffers);
  }

 private:
  std::unique_ptr<Socket> socket_;  // stays where it is when the stream moves
  std::unique_ptr<Encryption> encryption_;
};

inline boost::asio::ip::tcp::socket& tcp_socket(boost::asio::ip::tcp::socket& socket) {
  return socket;
}
/// Of a stream of Beast.
template <typename Socket>
boost::asio::ip::tcp::socket& tcp_socket(Socket& stream) {
  return stream.socket();
}

// Found by Beast: the end of a WebSocket is the end of the connection beneath it. The WebSocket has said goodbye
// itself.
template <typename Socket, typename Handler>
void async_teardown(boost::beast::role_type role, Stream<Socket>& stream, Handler&& handler) {
  boost::beast::websocket::async_teardown(role, tcp_socket(stream.socket()), std::forward<Handler>(handler));
}
template <typename Socket>
void beast_close_socket(Stream<Socket>& stream) {
  boost::system::error_code ignored;
  tcp_socket(stream.socket()).close(ignored);
}

}  // namespace surfcast::tls
