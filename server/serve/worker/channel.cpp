#include "worker/channel.h"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/socket.h>

namespace surfcast::worker {
namespace {

/// How long the other end may stop in the middle of a message.
constexpr std::chrono::milliseconds kPatience{10'000};
/// The longest message has all clip boxes, points and classes of a request, or all stages of a frame.
constexpr uint32_t kMaxBytes = uint32_t{64} << 20;

tl::unexpected<Error> gone(const char* why) {
  return fail(ErrorKind::kIo, std::string("the other end has gone: ") + why);
}

/// True if the socket is ready within this time, also for the end of the connection.
bool wait_for(int socket, short events, std::chrono::milliseconds most) {
  pollfd ready{socket, events, 0};
  for (;;) {
    const int count = ::poll(&ready, 1, static_cast<int>(most.count()));
    if (count < 0 && errno == EINTR) continue;
    return count > 0;
  }
}

union ControlBuffer {
  cmsghdr header;
  std::array<char, CMSG_SPACE(sizeof(int))> bytes;
};

/// Attaches a descriptor to a message of the socket.
void attach(msghdr& header, ControlBuffer& control, int descriptor) {
  header.msg_control = control.bytes.data();
  header.msg_controllen = control.bytes.size();
  cmsghdr* const first = CMSG_FIRSTHDR(&header);
  first->cmsg_level = SOL_SOCKET;
  first->cmsg_type = SCM_RIGHTS;
  first->cmsg_len = CMSG_LEN(sizeof(int));
  std::memcpy(CMSG_DATA(first), &descriptor, sizeof(int));
}

Descriptor attached(msghdr& header) {
  const cmsghdr* const first = CMSG_FIRSTHDR(&header);
  if (first == nullptr || first->cmsg_level != SOL_SOCKET || first->cmsg_type != SCM_RIGHTS) return {};
  int number = -1;
  std::memcpy(&number, CMSG_DATA(first), sizeof(int));
  return Descriptor(number);
}

}  // namespace

Result<std::pair<Channel, Channel>> Channel::make_pair() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return fail(ErrorKind::kIo, std::string("cannot make a pair of sockets: ") + std::strerror(errno));
  }
  return std::pair(Channel(Descriptor(ends[0])), Channel(Descriptor(ends[1])));
}

Status Channel::send(const Message& message, int descriptor) {
  const std::vector<std::byte> payload = encode(message);
  std::vector<std::byte> bytes(sizeof(uint32_t));
  const auto size = static_cast<uint32_t>(payload.size());
  std::memcpy(bytes.data(), &size, sizeof(size));
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  for (std::span<const std::byte> rest = bytes; !rest.empty();) {
    if (!wait_for(socket_.get(), POLLOUT, kPatience)) return gone("it takes nothing");
    iovec part{const_cast<std::byte*>(rest.data()), rest.size()};
    msghdr header{};
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    ControlBuffer control{};
    if (descriptor >= 0) attach(header, control, descriptor);
    const ssize_t count = ::sendmsg(socket_.get(), &header, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) return gone(std::strerror(errno));
    descriptor = -1;  // it travels with the first bytes
    rest = rest.subspan(static_cast<size_t>(count));
  }
  return {};
}

/// `descriptor`: takes one that comes along; null where none may.
Status Channel::read_all(std::span<std::byte> bytes, Descriptor* descriptor) {
  while (!bytes.empty()) {
    if (!wait_for(socket_.get(), POLLIN, kPatience)) return gone("it stopped in the middle of a message");
    iovec part{bytes.data(), bytes.size()};
    msghdr header{};
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    ControlBuffer control{};
    if (descriptor != nullptr) {
      header.msg_control = control.bytes.data();
      header.msg_controllen = control.bytes.size();
    }
    const ssize_t count = ::recvmsg(socket_.get(), &header, MSG_CMSG_CLOEXEC | MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) return gone(std::strerror(errno));
    if (count == 0) return gone("the connection was closed");
    if (Descriptor came = descriptor != nullptr ? attached(header) : Descriptor(); came) *descriptor = std::move(came);
    bytes = bytes.subspan(static_cast<size_t>(count));
  }
  return {};
}

Result<std::optional<Received>> Channel::receive(std::chrono::milliseconds most) {
  if (!wait_for(socket_.get(), POLLIN, most)) return std::nullopt;
  uint32_t size = 0;
  Descriptor descriptor;
  if (Status read = read_all(std::as_writable_bytes(std::span(&size, 1)), &descriptor); !read) {
    return fail(read);
  }
  if (size > kMaxBytes) return fail(ErrorKind::kInvalidInput, "a message of " + std::to_string(size) + " bytes");
  std::vector<std::byte> payload(size);
  if (Status read = read_all(payload, nullptr); !read) return fail(read);
  Result<Message> message = decode(payload);
  if (!message) return fail(message);
  return Received{std::move(*message), std::move(descriptor)};
}

}  // namespace surfcast::worker
