#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <utility>

#include "client/client_socket.h"
#include "client/message_channel.h"
#include "protocol/errors.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast::client {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

constexpr const char* kServerLeft = "the server closed the connection";

/// A socket on which Beast reports the end of a WebSocket, or what is wrong with it, as soon as it knows: by default it
/// would wait for the server to close the connection first.
class ImpatientSocket : public ClientSocket::Stream {
 public:
  explicit ImpatientSocket(ClientSocket::Stream stream) : ClientSocket::Stream(std::move(stream)) {}
};

/// Found by Beast.
template <typename Handler>
void async_teardown(beast::role_type /*role*/, ImpatientSocket& socket, Handler&& handler) {
  asio::post(socket.get_executor(), beast::bind_front_handler(std::forward<Handler>(handler), error_code()));
}

class WebSocketChannel : public MessageChannel {
 public:
  WebSocketChannel(std::unique_ptr<ClientSocket> socket, std::string host, std::string target);

  Result<Bytes> exchange_hellos(std::span<const std::byte> hello, TimePoint deadline) override;
  Status write(std::span<const std::byte> message, TimePoint deadline) override;
  Result<Bytes> read(TimePoint deadline) override;

 private:
  Status upgrade(TimePoint deadline);
  Status explain(const Status& outcome) const;

  std::unique_ptr<ClientSocket> socket_;  ///< whose connection stream_ has
  std::string host_;
  std::string target_;
  websocket::response_type response_;
  Bytes outgoing_;
  beast::flat_buffer incoming_;
  Operation upgrading_;
  Operation reading_;
  Operation writing_;
  websocket::stream<ImpatientSocket, /*deflate=*/false> stream_;
};

WebSocketChannel::WebSocketChannel(std::unique_ptr<ClientSocket> socket, std::string host, std::string target)
    : socket_(std::move(socket)),
      host_(std::move(host)),
      target_(std::move(target)),
      stream_(ImpatientSocket(std::move(socket_->stream()))) {
  stream_.binary(true);
  stream_.auto_fragment(false);
  stream_.read_message_max(protocol::kMaxAnswerBytes);
  stream_.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
    request.set(http::field::sec_websocket_protocol, beast::string_view(protocol::kWebSocketProtocol.data(),  //
                                                                        protocol::kWebSocketProtocol.size()));
  }));
}

/// Turns the connection into a WebSocket.
Status WebSocketChannel::upgrade(TimePoint deadline) {
  stream_.async_handshake(response_, host_, target_, upgrading_.begin());
  Status outcome = socket_->finish(upgrading_, deadline);
  if (outcome || upgrading_.pending) return outcome;
  const error_code& code = upgrading_.outcome;
  if (code == http::error::end_of_stream || code == http::error::partial_message) {
    return fail(ErrorKind::kIo, kServerLeft);
  }
  if (code == websocket::error::upgrade_declined) {
    const std::string answer = std::to_string(response_.result_int()) + " " + std::string(response_.reason());
    return fail(ErrorKind::kUnsupported, "no WebSocket was granted: " + protocol::clean_utf8(answer.substr(0, 100)));
  }
  const bool other = code == websocket::condition::handshake_failed ||
                     code.category() == http::make_error_code(http::error::end_of_stream).category();
  return other ? fail(ErrorKind::kUnsupported, "the peer does not speak WebSocket") : outcome;
}

Result<MessageChannel::Bytes> WebSocketChannel::exchange_hellos(std::span<const std::byte> hello, TimePoint deadline) {
  if (Status status = upgrade(deadline); !status) return fail(status);
  if (Status status = write(hello, deadline); !status) return fail(status);
  return read(deadline);
}

Status WebSocketChannel::write(std::span<const std::byte> message, TimePoint deadline) {
  if (Status status = socket_->finish(writing_, deadline); !status) return status;  // the message before
  outgoing_.assign(message.begin(), message.end());
  stream_.async_write(asio::buffer(outgoing_), writing_.begin());
  return socket_->finish(writing_, deadline);
}

/// What a failed read means.
Status WebSocketChannel::explain(const Status& outcome) const {
  if (reading_.pending) return outcome;
  const error_code& code = reading_.outcome;
  if (code == websocket::error::closed) return fail(ErrorKind::kIo, kServerLeft);
  if (code == websocket::error::message_too_big) {
    return fail(ErrorKind::kLimit, "the server sends more than a message may hold");
  }
  if (code == websocket::condition::protocol_violation) return fail(ErrorKind::kInvalidInput, code.message());
  return outcome;
}

Result<MessageChannel::Bytes> WebSocketChannel::read(TimePoint deadline) {
  if (socket_->interrupted()) return fail(ErrorKind::kCancelled, "interrupted");
  if (!reading_.begun) {
    incoming_.clear();
    stream_.async_read(incoming_, reading_.begin());
  }
  if (const Status outcome = socket_->finish(reading_, deadline); !outcome) return fail(explain(outcome));
  reading_.begun = false;
  if (!stream_.got_binary()) return fail(ErrorKind::kInvalidInput, "the server sends text");
  const auto* first = static_cast<const std::byte*>(incoming_.cdata().data());
  return Bytes(first, first + incoming_.size());
}

}  // namespace

std::unique_ptr<MessageChannel> make_websocket_channel(std::unique_ptr<ClientSocket> socket, const std::string& host,
                                                       const std::string& target) {
  return std::make_unique<WebSocketChannel>(std::move(socket), host, target);
}

}  // namespace surfcast::client
