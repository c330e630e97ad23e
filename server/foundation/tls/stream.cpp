#include "tls/stream.h"

#include <boost/asio/bind_executor.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace surfcast::tls {
namespace {

/// For operations that count no bytes.
auto without_bytes(IoHandler handler) {
  const IoHandler::executor_type executor = handler.get_executor();
  return boost::asio::bind_executor(
      executor, [handler = std::move(handler)](const boost::system::error_code& code) mutable { handler(code); });
}

}  // namespace

template <typename Socket>
void Stream<Socket>::start_read(const ReadBuffers& buffers, IoHandler handler) {
  if (encryption_) return encryption_->async_read_some(buffers, std::move(handler));
  socket_->async_read_some(buffers, std::move(handler));
}

template <typename Socket>
void Stream<Socket>::start_write(const WriteBuffers& buffers, IoHandler handler) {
  if (encryption_) return encryption_->async_write_some(buffers, std::move(handler));
  socket_->async_write_some(buffers, std::move(handler));
}

template <typename Socket>
void Stream<Socket>::start_handshake(HandshakeType type, IoHandler handler) {
  encryption_->async_handshake(type, without_bytes(std::move(handler)));
}

template <typename Socket>
void Stream<Socket>::start_shutdown(IoHandler handler) {
  encryption_->async_shutdown(without_bytes(std::move(handler)));
}

template <typename Socket>
void Stream<Socket>::start_read_beneath(const ReadBuffers& buffers, IoHandler handler) {
  socket_->async_read_some(buffers, std::move(handler));
}

template <typename Socket>
void Stream<Socket>::start_teardown(boost::beast::role_type role, IoHandler handler) {
  boost::beast::websocket::async_teardown(role, tcp_socket(*socket_), without_bytes(std::move(handler)));
}

template class Stream<boost::asio::ip::tcp::socket>;
template class Stream<boost::beast::tcp_stream>;

}  // namespace surfcast::tls
