#include "net/service_manager.h"

#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "protocol/parse.h"

namespace surfcast::net {
namespace {

/// The first of those that a service manager passes. sd_listen_fds(3)
constexpr int kFirstListener = 3;

std::optional<uint32_t> number_in(const char* variable) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? std::nullopt : protocol::parse_unsigned(text);
}

/// Whether a variable that names a process names this one.
bool is_for_us(const char* variable) {
  return number_in(variable) == static_cast<uint32_t>(::getpid());
}

}  // namespace

void notify_manager(const std::string& state) {
  const char* const path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  if (path == nullptr || (path[0] != '/' && path[0] != '@') || std::strlen(path) >= sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path, std::strlen(path));
  if (path[0] == '@') address.sun_path[0] = '\0';  // an abstract name
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return;
  ::sendto(descriptor, state.data(), state.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address), length);
  ::close(descriptor);
}

std::optional<std::chrono::microseconds> watchdog_interval() {
  const std::optional<uint32_t> timeout = number_in("WATCHDOG_USEC");
  if (!timeout || *timeout == 0 || (std::getenv("WATCHDOG_PID") != nullptr && !is_for_us("WATCHDOG_PID"))) {
    return std::nullopt;
  }
  return std::chrono::microseconds(*timeout / 2);
}

int inherited_listener() {
  if (!is_for_us("LISTEN_PID") || number_in("LISTEN_FDS").value_or(0) == 0) return -1;
  int listening = 0;
  socklen_t size = sizeof listening;
  if (::getsockopt(kFirstListener, SOL_SOCKET, SO_ACCEPTCONN, &listening, &size) != 0 || listening == 0) return -1;
  ::fcntl(kFirstListener, F_SETFD, FD_CLOEXEC);
  return kFirstListener;
}

}  // namespace surfcast::net
