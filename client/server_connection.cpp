#include "client/server_connection.h"

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "client/connect.h"
#include "protocol/errors.h"

namespace surfcast {

ServerConnection::ServerConnection(int descriptor, const Endpoint& server, const ClientConfig& config)
    : descriptor_(descriptor), endpoint_(server), config_(config) {}

ServerConnection::ServerConnection(ServerConnection&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      endpoint_(std::move(other.endpoint_)),
      config_(other.config_),
      server_(std::move(other.server_)),
      splitter_(std::move(other.splitter_)),
      last_id_(other.last_id_) {}

ServerConnection::~ServerConnection() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<ServerConnection> ServerConnection::open(const Endpoint& server, const ClientConfig& config) {
  const Clock::time_point deadline = Clock::now() + config.connect;
  const Result<int> descriptor = connect_to(server, deadline, config.interrupt);
  if (!descriptor) {
    return fail(descriptor.error().kind, to_string(server) + ": cannot connect: " + descriptor.error().message);
  }
  ServerConnection connection(*descriptor, server, config);
  if (Status status = connection.exchange_hellos(deadline); !status) return fail(status.error());
  return connection;
}

tl::unexpected<Error> ServerConnection::failed(ErrorKind kind, const std::string& what) const {
  return fail(kind, to_string(endpoint_) + ": " + what);
}

Status ServerConnection::exchange_hellos(Clock::time_point deadline) {
  if (Status status = write_all(encode_hello(make_hello("surfcast")), deadline); !status) return status;
  std::vector<std::byte> bytes(kHelloHeaderBytes);
  if (Status status = read_all(bytes, deadline); !status) return status;
  const Result<size_t> text = hello_text_bytes(std::span(bytes).first<kHelloHeaderBytes>());
  if (!text) return failed(text.error().kind, text.error().message);
  bytes.resize(kHelloHeaderBytes + *text);
  if (Status status = read_all(std::span(bytes).subspan(kHelloHeaderBytes), deadline); !status) return status;
  Result<Hello> hello = decode_hello(bytes);
  if (!hello) return failed(hello.error().kind, hello.error().message);
  if (Status status = check_server_hello(*hello); !status) return failed(status.error().kind, status.error().message);
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

Result<uint64_t> ServerConnection::send(wire::Request request) {
  request.set_id(++last_id_);
  const Result<std::vector<std::byte>> frame = encode_frame(request, kMaxRequestBytes);
  if (!frame) return fail(frame.error());
  if (Status status = write_all(*frame, Clock::now() + config_.answer); !status) return fail(status.error());
  return last_id_;
}

Result<wire::Answer> ServerConnection::receive() {
  const Clock::time_point deadline = Clock::now() + config_.answer;
  std::vector<std::byte> buffer(size_t{256} << 10);
  for (;;) {
    const Result<std::optional<std::vector<std::byte>>> frame = splitter_.next();
    if (!frame) return failed(frame.error().kind, frame.error().message);
    if (*frame) {
      wire::Answer answer;
      if (Status status = decode_message(**frame, answer); !status) {
        return failed(status.error().kind, status.error().message);
      }
      return answer;
    }
    const Result<size_t> count = read_some(buffer, deadline);
    if (!count) return fail(count.error());
    splitter_.append(std::span(buffer).first(*count));
  }
}

Result<wire::Answer> ServerConnection::ask(wire::Request request) {
  const Result<uint64_t> id = send(std::move(request));
  if (!id) return fail(id.error());
  for (;;) {
    Result<wire::Answer> answer = receive();
    if (!answer && answer.error().kind == ErrorKind::kCancelled) {
      wire::Request cancel;
      cancel.mutable_cancel()->set_request_id(*id);
      static_cast<void>(send(std::move(cancel)));  // a courtesy: closing the connection cancels as well
    }
    if (!answer) return answer;
    if (answer->id() != *id && answer->id() != 0) continue;
    if (!answer->has_error()) return answer;
    const Error error = from_wire(answer->error());
    return failed(error.kind, error.message);
  }
}

}  // namespace surfcast
