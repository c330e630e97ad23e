#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <span>
#include <utility>

#include "net/redirect_error_to.h"
#include "net/transports.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

class FramedTransport : public Transport {
 public:
  FramedTransport(ClientStream stream, Bytes begun, size_t request_bytes)
      : stream_(std::move(stream)), begun_(std::move(begun)), splitter_(request_bytes) {}

  Awaitable<Result<Bytes>> read_hello() override;
  Awaitable<Result<std::optional<Bytes>>> read() override;
  Awaitable<bool> write_hello(const Bytes& hello) override;
  Awaitable<bool> write(const Bytes& message, const std::function<void(size_t)>& progress) override;
  Awaitable<void> linger() override;
  Awaitable<void> send_close() override;
  bool keep_alive(Clock::time_point /*now*/) override { return true; }  // TCP sees to it
  void close() override;
  [[nodiscard]] std::optional<Clock::time_point> reading_since() const override { return reading_since_; }
  [[nodiscard]] bool is_open() const override { return stream_.socket().socket().is_open(); }
  [[nodiscard]] asio::any_io_executor executor() override { return stream_.get_executor(); }

 private:
  [[nodiscard]] tcp::socket& tcp_socket() { return stream_.socket().socket(); }

  ClientStream stream_;
  Bytes begun_;  ///< of the hello
  protocol::FrameSplitter splitter_;
  std::array<std::byte, 4096> buffer_{};
  std::optional<Clock::time_point> reading_since_;
};

asio::awaitable<Result<Bytes>> FramedTransport::read_hello() {
  error_code code;
  Bytes bytes = std::exchange(begun_, {});
  const size_t begun = bytes.size();
  bytes.resize(protocol::kHelloHeaderBytes);
  co_await asio::async_read(stream_, asio::buffer(bytes) + begun, redirect_error_to(code));
  if (code) co_return fail(ErrorKind::kIo, code.message());
  const Result<size_t> text = protocol::hello_text_bytes(std::span(bytes).first<protocol::kHelloHeaderBytes>());
  if (!text) co_return fail(text);
  bytes.resize(protocol::kHelloHeaderBytes + *text);
  co_await asio::async_read(stream_, asio::buffer(bytes.data() + protocol::kHelloHeaderBytes, *text),
                            redirect_error_to(code));
  if (code) co_return fail(ErrorKind::kIo, code.message());
  co_return bytes;
}

asio::awaitable<Result<std::optional<Bytes>>> FramedTransport::read() {
  for (;;) {
    Result<std::optional<Bytes>> frame = splitter_.next();
    if (!frame || frame->has_value()) {
      reading_since_.reset();
      co_return frame;
    }
    if (!reading_since_ && splitter_.begun()) reading_since_ = Clock::now();
    error_code code;
    const size_t count = co_await stream_.async_read_some(asio::buffer(buffer_), redirect_error_to(code));
    if (code) co_return std::nullopt;
    splitter_.append(std::span(buffer_).first(count));
  }
}

asio::awaitable<bool> FramedTransport::write_hello(const Bytes& hello) {
  error_code code;
  co_await asio::async_write(stream_, asio::buffer(hello), redirect_error_to(code));
  co_return !code;
}

asio::awaitable<bool> FramedTransport::write(const Bytes& message, const std::function<void(size_t)>& progress) {
  const auto header = protocol::frame_header(message.size());
  std::array<asio::const_buffer, 2> rest{asio::buffer(header), asio::buffer(message)};
  error_code code;
  while (asio::buffer_size(rest) > 0 && !code) {
    const size_t sent = co_await stream_.async_write_some(rest, redirect_error_to(code));
    const size_t of_header = std::min(sent, rest[0].size());
    rest[0] += of_header;
    rest[1] += sent - of_header;
    progress(sent);
  }
  co_return !code;
}

/// Closing at once would reset the connection if bytes of the client are unread, and a reset may throw away what is
/// still on its way to it.
asio::awaitable<void> FramedTransport::linger() {
  error_code code;
  if (stream_.is_encrypted()) co_await stream_.async_shutdown(redirect_error_to(code));
  tcp_socket().shutdown(tcp::socket::shutdown_send, code);
  while (!code) {
    co_await stream_.async_read_beneath(asio::buffer(buffer_), redirect_error_to(code));
  }
}

asio::awaitable<void> FramedTransport::send_close() {
  error_code ignored;
  tcp_socket().shutdown(tcp::socket::shutdown_send, ignored);
  co_return;
}

void FramedTransport::close() {
  error_code ignored;
  tcp_socket().shutdown(tcp::socket::shutdown_both, ignored);
  stream_.socket().close();
}

}  // namespace

std::shared_ptr<Transport> make_framed_transport(ClientStream stream, Bytes begun, size_t request_bytes) {
  return std::make_shared<FramedTransport>(std::move(stream), std::move(begun), request_bytes);
}

}  // namespace surfcast::net
