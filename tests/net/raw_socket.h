#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace surfcast::net {

/// A plain loopback socket for tests that say what no well-behaved client says.
class RawSocket {
 public:
  /// A server that is asked for its first picture starts a worker, which takes long on a busy machine.
  static constexpr std::chrono::seconds kPatience{60};

  /// `source`: the address of the loopback that the client has.
  explicit RawSocket(uint16_t port, int receive_buffer = 0, const char* source = "127.0.0.1")
      : descriptor_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    ::inet_pton(AF_INET, source, &own.sin_addr);
    ::bind(descriptor_, reinterpret_cast<sockaddr*>(&own), sizeof own);
    if (receive_buffer > 0) ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~RawSocket() { close(); }
  RawSocket(RawSocket&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), connected_(other.connected_), ended_(other.ended_) {}
  RawSocket& operator=(RawSocket&&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }

  /// False when the server has closed the connection.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return false;
      bytes.remove_prefix(static_cast<size_t>(count));
    }
    return true;
  }
  bool send(std::span<const std::byte> bytes) {
    return send(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }

  /// Sends all of it, or false: nothing is taken for a second.
  bool send_some(std::string_view bytes) {
    const timeval patience{1, 0};
    ::setsockopt(descriptor_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    return send(bytes);
  }

  /// What arrives until the server closes, or nothing more comes for `timeout`.
  std::string read_to_end(std::chrono::milliseconds timeout = kPatience) {
    std::string all;
    while (read_some(all, timeout)) {
    }
    return all;
  }
  /// Reads until `count` bytes are there.
  std::string read_exactly(size_t count) {
    std::string all;
    while (all.size() < count && read_some(all, kPatience, count - all.size())) {
    }
    return all;
  }
  /// Reads one answer of HTTP: the header, and as many bytes as its Content-Length says.
  std::string read_http() {
    std::string all;
    while (all.find("\r\n\r\n") == std::string::npos) {
      if (!read_some(all, kPatience, 1)) return all;
    }
    const size_t field = all.find("Content-Length: ");
    const size_t length = field == std::string::npos ? 0 : std::stoul(all.substr(field + 16));
    return all + read_exactly(length);
  }
  /// Whether the server has closed the connection, as seen within `timeout`.
  bool closed_within(std::chrono::milliseconds timeout) {
    read_to_end(timeout);
    return ended_;
  }
  /// Sends nothing more, but goes on reading.
  void shut_down() { ::shutdown(descriptor_, SHUT_WR); }
  /// Closes without a word, as a process does that is killed.
  void close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }
  void reset() {
    const linger now{1, 0};
    ::setsockopt(descriptor_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close();
  }

 private:
  bool read_some(std::string& all, std::chrono::milliseconds timeout, size_t most = 65536) {
    pollfd watched{descriptor_, POLLIN, 0};
    if (::poll(&watched, 1, static_cast<int>(timeout.count())) <= 0) return false;
    std::array<char, 65536> buffer{};
    const ssize_t count = ::recv(descriptor_, buffer.data(), std::min(most, buffer.size()), 0);
    ended_ = count <= 0;
    if (count > 0) all.append(buffer.data(), static_cast<size_t>(count));
    return count > 0;
  }

  int descriptor_;
  bool connected_ = false;
  bool ended_ = false;
};

}  // namespace surfcast::net
