#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "protocol/endpoint.h"

namespace surfcast::client {

inline constexpr std::chrono::milliseconds kLong{20'000};  // for what does come, however busy the machine

/// Accepts one connection and says what it is told, whatever the client sends.
class ScriptedServer {
 public:
  explicit ScriptedServer(std::string words, bool stays = false) : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ::listen(listener_, 1);
    socklen_t size = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this, said = std::move(words), stays] { speak(said, stays); });
  }
  ~ScriptedServer() {
    ::shutdown(listener_, SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
    ::close(listener_);
  }
  ScriptedServer(const ScriptedServer&) = delete;
  ScriptedServer& operator=(const ScriptedServer&) = delete;

  [[nodiscard]] protocol::Endpoint endpoint() const { return {"127.0.0.1", port_}; }
  /// What the client sent; ask when it has closed its connection.
  const std::string& heard() {
    thread_.join();
    return heard_;
  }

 private:
  void speak(const std::string& words, bool stays) {
    const int peer = ::accept(listener_, nullptr, nullptr);
    if (peer < 0) return;
    ::send(peer, words.data(), words.size(), MSG_NOSIGNAL);
    std::array<char, 4096> buffer{};
    if (!stays) ::shutdown(peer, SHUT_WR);
    while (const ssize_t count = ::recv(peer, buffer.data(), buffer.size(), 0)) {
      if (count < 0) break;
      heard_.append(buffer.data(), static_cast<size_t>(count));
    }
    ::close(peer);
  }

  int listener_;
  uint16_t port_ = 0;
  std::string heard_;
  std::jthread thread_;
};

}  // namespace surfcast::client
