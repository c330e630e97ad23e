#include "client/connect.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace surfcast::client {
namespace {

using Clock = std::chrono::steady_clock;
using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

/// Waits for the result of a non-blocking connect(2).
Status finish_connecting(int descriptor, Clock::time_point deadline, int interrupt) {
  if (Status status = wait_for(descriptor, POLLOUT, deadline, interrupt); !status) return status;
  int code = 0;
  socklen_t size = sizeof code;
  ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &code, &size);
  if (code != 0) return fail(ErrorKind::kIo, std::strerror(code));
  return {};
}

Result<int> connect_one(const addrinfo& address, Clock::time_point deadline, int interrupt) {
  const int descriptor = ::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return fail(ErrorKind::kIo, std::strerror(errno));
  Status status;
  if (::connect(descriptor, address.ai_addr, address.ai_addrlen) != 0) {
    status = errno == EINPROGRESS ? finish_connecting(descriptor, deadline, interrupt)
                                  : fail(ErrorKind::kIo, std::strerror(errno));
  }
  if (!status) {
    ::close(descriptor);
    return fail(status.error());
  }
  const int on = 1;
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return descriptor;
}

}  // namespace

Status wait_for(int descriptor, short events, Clock::time_point deadline, int interrupt) {
  std::array<pollfd, 2> watched{{{descriptor, events, 0}, {interrupt, POLLIN, 0}}};
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    const int ready = ::poll(watched.data(), watched.size(), static_cast<int>(std::clamp<long>(left, 0, 1 << 30)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) return fail(ErrorKind::kIo, std::strerror(errno));
    if (watched[1].revents != 0) return fail(ErrorKind::kCancelled, "interrupted");
    if (watched[0].revents != 0) return {};
    if (left <= 0) return fail(ErrorKind::kUnavailable, "timed out");
  }
}

Result<int> connect_to(const protocol::Endpoint& server, Clock::time_point deadline, int interrupt) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  const int code = ::getaddrinfo(server.host.c_str(), std::to_string(server.port).c_str(), &hints, &list);
  if (code != 0) return fail(ErrorKind::kIo, ::gai_strerror(code));
  const Addresses addresses(list, &::freeaddrinfo);
  Result<int> connected = fail(ErrorKind::kIo, "no address");
  for (const addrinfo* address = list; address != nullptr && !connected; address = address->ai_next) {
    connected = connect_one(*address, deadline, interrupt);
    if (!connected && connected.error().kind == ErrorKind::kCancelled) break;
  }
  return connected;
}

}  // namespace surfcast::client
