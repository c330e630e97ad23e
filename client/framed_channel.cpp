#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <optional>
#include <utility>

#include "client/client_socket.h"
#include "client/message_channel.h"
#include "protocol/framing.h"
#include "protocol/hello.h"

namespace surfcast::client {
namespace {

namespace asio = boost::asio;

constexpr size_t kReadBytes = size_t{256} << 10;  // at a time

class FramedChannel : public MessageChannel {
 public:
  explicit FramedChannel(std::unique_ptr<ClientSocket> socket) : socket_(std::move(socket)) {}

  Result<Bytes> exchange_hellos(std::span<const std::byte> hello, TimePoint deadline) override;
  Status write(std::span<const std::byte> message, TimePoint deadline) override;
  Result<Bytes> read(TimePoint deadline) override;

 private:
  Status send(TimePoint deadline);
  Status receive(std::span<std::byte> bytes, TimePoint deadline);

  // Buffers and operations end after the socket that uses them.
  protocol::FrameSplitter splitter_{protocol::kMaxAnswerBytes};
  Bytes incoming_ = Bytes(kReadBytes);
  Bytes outgoing_;
  Operation reading_;
  Operation writing_;
  std::unique_ptr<ClientSocket> socket_;
};

/// Sends what is in outgoing_.
Status FramedChannel::send(TimePoint deadline) {
  asio::async_write(socket_->stream(), asio::buffer(outgoing_), writing_.begin());
  return socket_->finish(writing_, deadline);
}

/// Fills a part of incoming_.
Status FramedChannel::receive(std::span<std::byte> bytes, TimePoint deadline) {
  asio::async_read(socket_->stream(), asio::buffer(bytes.data(), bytes.size()), reading_.begin());
  return socket_->finish(reading_, deadline);
}

Result<MessageChannel::Bytes> FramedChannel::exchange_hellos(std::span<const std::byte> hello, TimePoint deadline) {
  outgoing_.assign(hello.begin(), hello.end());
  if (Status status = send(deadline); !status) return fail(status);
  const auto header = std::span(incoming_).first<protocol::kHelloHeaderBytes>();
  if (Status status = receive(header, deadline); !status) return fail(status);
  const Result<size_t> text = protocol::hello_text_bytes(header);
  if (!text) return fail(text);
  const std::span<std::byte> answer = std::span(incoming_).first(protocol::kHelloHeaderBytes + *text);
  if (Status status = receive(answer.subspan(protocol::kHelloHeaderBytes), deadline); !status) return fail(status);
  reading_.begun = false;
  return Bytes(answer.begin(), answer.end());
}

Status FramedChannel::write(std::span<const std::byte> message, TimePoint deadline) {
  if (Status status = socket_->finish(writing_, deadline); !status) return status;  // the message before
  const auto header = protocol::frame_header(message.size());
  outgoing_.assign(header.begin(), header.end());
  outgoing_.insert(outgoing_.end(), message.begin(), message.end());
  return send(deadline);
}

Result<MessageChannel::Bytes> FramedChannel::read(TimePoint deadline) {
  if (socket_->interrupted()) return fail(ErrorKind::kCancelled, "interrupted");
  for (;;) {
    Result<std::optional<Bytes>> message = splitter_.next();
    if (!message) return fail(message);
    if (*message) return std::move(**message);
    if (!reading_.begun) socket_->stream().async_read_some(asio::buffer(incoming_), reading_.begin());
    if (Status status = socket_->finish(reading_, deadline); !status) return fail(status);
    reading_.begun = false;
    splitter_.append(std::span(incoming_).first(reading_.bytes));
  }
}

}  // namespace

std::unique_ptr<MessageChannel> make_framed_channel(std::unique_ptr<ClientSocket> socket) {
  return std::make_unique<FramedChannel>(std::move(socket));
}

}  // namespace surfcast::client
