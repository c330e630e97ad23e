#include "client/server_connection.h"

#include <cerrno>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "client/connect.h"
#include "client/websocket_stream.h"
#include "protocol/errors.h"
#include "protocol/framing.h"

namespace surfcast::client {

namespace {

constexpr size_t kReadBytes = size_t{256} << 10;          // per recv(2)
constexpr size_t kMaxHttpHeaderBytes = size_t{16} << 10;  // of the response to the WebSocket upgrade

}  // namespace

ServerConnection::ServerConnection(int descriptor, const protocol::Endpoint& server, const ClientConfig& config)
    : descriptor_(descriptor),
      endpoint_(server),
      config_(config),
      stream_(server.websocket ? make_websocket_stream() : make_framed_stream()),
      buffer_(kReadBytes) {}

ServerConnection::ServerConnection(ServerConnection&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      endpoint_(std::move(other.endpoint_)),
      config_(other.config_),
      server_(std::move(other.server_)),
      stream_(std::move(other.stream_)),
      buffer_(std::move(other.buffer_)),
      bytes_received_(other.bytes_received_),
      last_id_(other.last_id_) {}

ServerConnection::~ServerConnection() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<ServerConnection> ServerConnection::open(const protocol::Endpoint& server, const ClientConfig& config) {
  const Clock::time_point deadline = Clock::now() + config.connect;
  const Result<int> descriptor = connect_to(server, deadline, config.interrupt);
  if (!descriptor) {
    return fail(descriptor.error().kind,
                protocol::to_string(server) + ": cannot connect: " + descriptor.error().message);
  }
  ServerConnection connection(*descriptor, server, config);
  if (Status status = connection.exchange_hellos(deadline); !status) return fail(status.error());
  return connection;
}

tl::unexpected<Error> ServerConnection::failed(ErrorKind kind, const std::string& what) const {
  return fail(kind, protocol::to_string(endpoint_) + ": " + what);
}

Result<std::vector<std::byte>> ServerConnection::greet_framed(Clock::time_point deadline) {
  if (Status status = write_all(protocol::encode_hello(protocol::make_hello("surfcast")), deadline); !status)
    return fail(status.error());
  std::vector<std::byte> bytes(protocol::kHelloHeaderBytes);
  if (Status status = read_all(bytes, deadline); !status) return fail(status.error());
  const Result<size_t> text = protocol::hello_text_bytes(std::span(bytes).first<protocol::kHelloHeaderBytes>());
  if (!text) return failed(text.error().kind, text.error().message);
  bytes.resize(protocol::kHelloHeaderBytes + *text);
  if (Status status = read_all(std::span(bytes).subspan(protocol::kHelloHeaderBytes), deadline); !status) {
    return fail(status.error());
  }
  return bytes;
}

/// Upgrades the connection to a WebSocket.
Status ServerConnection::upgrade(Clock::time_point deadline) {
  std::random_device random;
  std::string key(16, '\0');
  for (char& c : key) c = static_cast<char>(random() & 0xff);
  const auto handshake = WebSocketHandshake::make(protocol::to_string(endpoint_), key);
  if (Status status = write_all(std::as_bytes(std::span(handshake.request)), deadline); !status) return status;
  std::string answer;
  while (!answer.ends_with("\r\n\r\n") && answer.size() < kMaxHttpHeaderBytes) {
    std::byte next{};  // one byte at a time: the bytes after the header are WebSocket frames
    const Result<size_t> count = read_some({&next, 1}, deadline);
    if (!count) return fail(count.error());
    answer += static_cast<char>(next);
  }
  if (const Status granted = handshake.check(answer); !granted) {
    return failed(granted.error().kind, protocol::clean_utf8(granted.error().message));
  }
  return {};
}

Result<std::vector<std::byte>> ServerConnection::greet_websocket(Clock::time_point deadline) {
  if (Status status = upgrade(deadline); !status) return fail(status.error());
  const std::vector<std::byte> hello = stream_->encode(protocol::encode_hello(protocol::make_hello("surfcast")));
  if (Status status = write_all(hello, deadline); !status) return fail(status.error());
  for (;;) {
    Result<std::optional<std::vector<std::byte>>> message = stream_->next();
    if (!message) return failed(message.error().kind, message.error().message);
    if (*message) return std::move(**message);
    const Result<size_t> count = read_some(buffer_, deadline);
    if (!count) return fail(count.error());
    stream_->append(std::span(buffer_).first(*count));
  }
}

Status ServerConnection::exchange_hellos(Clock::time_point deadline) {
  const Result<std::vector<std::byte>> bytes = endpoint_.websocket ? greet_websocket(deadline) : greet_framed(deadline);
  if (!bytes) return fail(bytes.error());
  Result<protocol::Hello> hello = protocol::decode_hello(*bytes);
  if (!hello) return failed(hello.error().kind, hello.error().message);
  if (Status status = protocol::check_server_hello(*hello); !status)
    return failed(status.error().kind, status.error().message);
  server_ = std::move(*hello);
  return {};
}

Status ServerConnection::wait(short events, Clock::time_point deadline) const {
  const Status status = wait_for(descriptor_, events, deadline, config_.interrupt);
  if (!status) return failed(status.error().kind, status.error().message);
  return {};
}

Status ServerConnection::write_all(std::span<const std::byte> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count >= 0) {
      bytes = bytes.subspan(static_cast<size_t>(count));
    } else if (errno == EAGAIN || errno == EINTR) {
      if (Status status = wait(POLLOUT, deadline); !status) return status;
    } else {
      return failed(ErrorKind::kIo, std::strerror(errno));
    }
  }
  return {};
}

Result<size_t> ServerConnection::read_some(std::span<std::byte> bytes, Clock::time_point deadline) {
  for (;;) {
    if (Status status = wait(POLLIN, deadline); !status) return fail(status.error());
    const ssize_t count = ::recv(descriptor_, bytes.data(), bytes.size(), 0);
    if (count > 0) bytes_received_ += static_cast<uint64_t>(count);
    if (count > 0) return static_cast<size_t>(count);
    if (count == 0) return failed(ErrorKind::kIo, "the server closed the connection");
    if (errno != EAGAIN && errno != EINTR) return failed(ErrorKind::kIo, std::strerror(errno));
  }
}

Status ServerConnection::read_all(std::span<std::byte> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    const Result<size_t> count = read_some(bytes, deadline);
    if (!count) return fail(count.error());
    bytes = bytes.subspan(*count);
  }
  return {};
}

Status ServerConnection::send_as(uint64_t id, wire::Request request) {
  request.set_id(id);
  const std::string message = request.SerializeAsString();
  if (message.size() > protocol::kMaxRequestBytes)
    return fail(ErrorKind::kLimit, "the request is larger than a server reads");
  return write_all(stream_->encode(std::as_bytes(std::span(message))), Clock::now() + config_.answer);
}

Result<uint64_t> ServerConnection::send(wire::Request request) {
  if (Status status = send_as(++last_id_, std::move(request)); !status) return fail(status.error());
  return last_id_;
}

/// The next answer in the bytes received so far; nothing while it is incomplete.
Result<std::optional<wire::Answer>> ServerConnection::next_answer() {
  const Result<std::optional<std::vector<std::byte>>> message = stream_->next();
  if (const std::vector<std::byte> replies = stream_->take_replies(); !replies.empty()) {
    if (Status status = write_all(replies, Clock::now() + config_.answer); !status) return fail(status.error());
  }
  if (!message) return failed(message.error().kind, message.error().message);
  if (!*message) return std::nullopt;
  wire::Answer answer;
  if (Status status = protocol::decode_message(**message, answer); !status) {
    return failed(status.error().kind, status.error().message);
  }
  return answer;
}

Result<std::optional<wire::Answer>> ServerConnection::receive_until(Clock::time_point deadline) {
  for (;;) {
    Result<std::optional<wire::Answer>> answer = next_answer();
    if (!answer || answer->has_value()) return answer;
    const Result<size_t> count = read_some(buffer_, deadline);
    if (!count && count.error().kind == ErrorKind::kUnavailable) return std::nullopt;
    if (!count) return fail(count.error());
    stream_->append(std::span(buffer_).first(*count));
  }
}

Result<wire::Answer> ServerConnection::receive() {
  Result<std::optional<wire::Answer>> answer = receive_until(Clock::now() + config_.answer);
  if (!answer) return fail(answer.error());
  if (!*answer) return failed(ErrorKind::kUnavailable, "timed out");
  return std::move(**answer);
}

Result<wire::Answer> ServerConnection::ask(wire::Request request) {
  const Result<uint64_t> id = send(std::move(request));
  if (!id) return fail(id.error());
  for (;;) {
    Result<wire::Answer> answer = receive();
    if (!answer && answer.error().kind == ErrorKind::kCancelled) {
      wire::Request cancel;
      cancel.mutable_cancel()->set_request_id(*id);
      static_cast<void>(send(std::move(cancel)));  // may fail: closing the connection cancels the request as well
    }
    if (!answer) return answer;
    if (answer->id() != *id && answer->id() != 0) continue;
    if (!answer->has_error()) return answer;
    const Error error = protocol::from_wire(answer->error());
    return failed(error.kind, error.message);
  }
}

}  // namespace surfcast::client
