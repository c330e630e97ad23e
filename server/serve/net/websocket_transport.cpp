#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <string>
#include <utility>

#include "net/heartbeat.h"
#include "net/redirect_error_to.h"
#include "net/transports.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

/// Bytes of one frame of a message: small enough that the client's progress is seen, and that an answer to a ping is
/// not held up by a picture.
constexpr size_t kFragmentBytes = size_t{64} << 10;

class WebSocketTransport : public Transport, public std::enable_shared_from_this<WebSocketTransport> {
 public:
  WebSocketTransport(ClientStream stream, UpgradeHead head, std::chrono::milliseconds ping, size_t request_bytes);

  Awaitable<Result<Bytes>> read_hello() override;
  Awaitable<Result<std::optional<Bytes>>> read() override;
  Awaitable<bool> write_hello(const Bytes& hello) override;
  Awaitable<bool> write(const Bytes& message, const std::function<void(size_t)>& progress) override;
  Awaitable<void> linger() override { return part(websocket::close_code::normal); }
  Awaitable<void> send_close() override { return part(websocket::close_code::going_away); }
  bool keep_alive(Clock::time_point now) override;
  void close() override;
  [[nodiscard]] std::optional<Clock::time_point> reading_since() const override { return reading_since_; }
  [[nodiscard]] bool is_open() const override { return open_; }
  [[nodiscard]] asio::any_io_executor executor() override { return stream_.get_executor(); }

 private:
  void hear(websocket::frame_type type);
  void close_socket();
  Awaitable<void> part(websocket::close_code reason);

  websocket::stream<ClientStream> stream_;
  UpgradeHead head_;
  Heartbeat heartbeat_;
  bool open_ = true;  ///< until close(): the stream closes its socket by itself when the client says goodbye
  bool granted_ = false;
  bool reading_ = false;
  std::optional<Clock::time_point> reading_since_;
};

WebSocketTransport::WebSocketTransport(ClientStream stream, UpgradeHead head, std::chrono::milliseconds ping,
                                       size_t request_bytes)
    : stream_(std::move(stream)), head_(std::move(head)), heartbeat_(ping, Clock::now()) {
  stream_.auto_fragment(false);
  stream_.binary(true);
  stream_.read_message_max(request_bytes);
  stream_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    response.set(http::field::server, "surfcastd");
    response.set(http::field::sec_websocket_protocol, beast::string_view(protocol::kWebSocketProtocol.data(),  //
                                                                         protocol::kWebSocketProtocol.size()));
  }));
  stream_.control_callback([this](websocket::frame_type type, beast::string_view) { hear(type); });
}

void WebSocketTransport::hear(websocket::frame_type type) {
  heartbeat_.hear(Clock::now());
  if (type != websocket::frame_type::close) return;
  // The stream answers now, but would then wait for as long as the client likes before it reports the end.
  asio::post(stream_.get_executor(), [self = shared_from_this()] { self->close_socket(); });
}

asio::awaitable<Result<Bytes>> WebSocketTransport::read_hello() {
  error_code code;
  co_await stream_.async_accept(head_, redirect_error_to(code));
  if (code) co_return fail(ErrorKind::kIo, code.message());
  head_ = {};
  granted_ = true;
  Result<std::optional<Bytes>> hello = co_await read();
  if (!hello) co_return fail(hello);
  if (!hello->has_value()) co_return fail(ErrorKind::kIo, "the client is gone");
  co_return std::move(**hello);
}

asio::awaitable<Result<std::optional<Bytes>>> WebSocketTransport::read() {
  error_code code;
  beast::flat_buffer buffer;  // of its own: a connection that is silent holds no memory for messages
  reading_ = true;
  do {
    co_await stream_.async_read_some(buffer, 0, redirect_error_to(code));
    if (!reading_since_) reading_since_ = Clock::now();
  } while (!code && !stream_.is_message_done());
  reading_ = false;
  reading_since_.reset();
  if (code) co_return std::nullopt;
  heartbeat_.hear(Clock::now());
  if (!stream_.got_binary()) co_return fail(ErrorKind::kInvalidInput, "a message of text is not understood");
  const auto* first = static_cast<const std::byte*>(buffer.cdata().data());
  co_return Bytes(first, first + buffer.size());
}

asio::awaitable<bool> WebSocketTransport::write_hello(const Bytes& hello) {
  error_code code;
  co_await stream_.async_write(asio::buffer(hello), redirect_error_to(code));
  co_return !code;
}

asio::awaitable<bool> WebSocketTransport::write(const Bytes& message, const std::function<void(size_t)>& progress) {
  error_code code;
  for (size_t sent = 0; sent < message.size() && !code;) {
    const size_t count = std::min(kFragmentBytes, message.size() - sent);
    const bool last = sent + count == message.size();
    co_await stream_.async_write_some(last, asio::buffer(message.data() + sent, count), redirect_error_to(code));
    sent += count;
    progress(count);
  }
  co_return !code;
}

/// Returns when the client has said goodbye, too.
asio::awaitable<void> WebSocketTransport::part(websocket::close_code reason) {
  error_code ignored;
  // With a callback, a read that finds the client's goodbye goes on only in a later turn. If this goodbye has been
  // written meanwhile, read and close wait for each other for ever (Beast 1.81).
  stream_.control_callback();
  if (granted_) co_await stream_.async_close(reason, redirect_error_to(ignored));
}

bool WebSocketTransport::keep_alive(Clock::time_point now) {
  if (!reading_ || !granted_) {  // nothing would be heard: this time does not count
    heartbeat_.hear(now);
    return true;
  }
  const Heartbeat::Step step = heartbeat_.poll(now);
  if (step == Heartbeat::Step::kAsk) stream_.async_ping({}, [self = shared_from_this()](error_code) {});
  return step != Heartbeat::Step::kGone;
}

void WebSocketTransport::close() {
  open_ = false;
  close_socket();
}

void WebSocketTransport::close_socket() {
  error_code ignored;
  beast::tcp_stream& connection = stream_.next_layer().socket();
  connection.socket().shutdown(tcp::socket::shutdown_both, ignored);
  connection.close();
}

}  // namespace

std::shared_ptr<Transport> make_websocket_transport(ClientStream stream, UpgradeHead head,
                                                    std::chrono::milliseconds ping, size_t request_bytes) {
  return std::make_shared<WebSocketTransport>(std::move(stream), std::move(head), ping, request_bytes);
}

}  // namespace surfcast::net
