#include "net/framed_transport.h"

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <span>
#include <utility>

#include "net/redirect_error_to.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

class FramedTransport : public Transport {
 public:
  FramedTransport(tcp::socket socket, size_t request_bytes) : socket_(std::move(socket)), splitter_(request_bytes) {}

  Awaitable<Result<Bytes>> read_hello() override;
  Awaitable<Result<std::optional<Bytes>>> read() override;
  Awaitable<bool> write_hello(const Bytes& hello) override;
  Awaitable<bool> write(const Bytes& message, const std::function<void()>& progress) override;
  Awaitable<void> linger() override;
  Awaitable<void> send_close() override { co_return; }
  bool keep_alive(Clock::time_point /*now*/) override { return true; }  // TCP sees to it
  void close() override;
  [[nodiscard]] bool is_open() const override { return socket_.is_open(); }
  [[nodiscard]] asio::any_io_executor executor() override { return socket_.get_executor(); }

 private:
  tcp::socket socket_;
  protocol::FrameSplitter splitter_;
  std::array<std::byte, 4096> buffer_{};
};

asio::awaitable<Result<Bytes>> FramedTransport::read_hello() {
  error_code code;
  Bytes bytes(protocol::kHelloHeaderBytes);
  co_await asio::async_read(socket_, asio::buffer(bytes), redirect_error_to(code));
  if (code) co_return fail(ErrorKind::kIo, code.message());
  const Result<size_t> text = protocol::hello_text_bytes(std::span(bytes).first<protocol::kHelloHeaderBytes>());
  if (!text) co_return fail(text.error());
  bytes.resize(protocol::kHelloHeaderBytes + *text);
  co_await asio::async_read(socket_, asio::buffer(bytes.data() + protocol::kHelloHeaderBytes, *text),
                            redirect_error_to(code));
  if (code) co_return fail(ErrorKind::kIo, code.message());
  co_return bytes;
}

asio::awaitable<Result<std::optional<Bytes>>> FramedTransport::read() {
  for (;;) {
    Result<std::optional<Bytes>> frame = splitter_.next();
    if (!frame || frame->has_value()) co_return frame;
    error_code code;
    const size_t count = co_await socket_.async_read_some(asio::buffer(buffer_), redirect_error_to(code));
    if (code) co_return std::nullopt;
    splitter_.append(std::span(buffer_).first(count));
  }
}

asio::awaitable<bool> FramedTransport::write_hello(const Bytes& hello) {
  error_code code;
  co_await asio::async_write(socket_, asio::buffer(hello), redirect_error_to(code));
  co_return !code;
}

asio::awaitable<bool> FramedTransport::write(const Bytes& message, const std::function<void()>& progress) {
  const auto header = protocol::frame_header(message.size());
  std::array<asio::const_buffer, 2> rest{asio::buffer(header), asio::buffer(message)};
  error_code code;
  while (asio::buffer_size(rest) > 0 && !code) {
    const size_t sent = co_await socket_.async_write_some(rest, redirect_error_to(code));
    const size_t of_header = std::min(sent, rest[0].size());
    rest[0] += of_header;
    rest[1] += sent - of_header;
    progress();
  }
  co_return !code;
}

/// Closing at once would reset the connection if bytes of the client are unread, and a reset may throw away what is
/// still on its way to it.
asio::awaitable<void> FramedTransport::linger() {
  error_code code;
  socket_.shutdown(tcp::socket::shutdown_send, code);
  while (!code) {
    co_await socket_.async_read_some(asio::buffer(buffer_), redirect_error_to(code));
  }
}

void FramedTransport::close() {
  error_code ignored;
  socket_.shutdown(tcp::socket::shutdown_both, ignored);
  socket_.close(ignored);
}

}  // namespace

std::shared_ptr<Transport> make_framed_transport(tcp::socket socket, size_t request_bytes) {
  return std::make_shared<FramedTransport>(std::move(socket), request_bytes);
}

}  // namespace surfcast::net
