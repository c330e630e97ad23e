#include "support/link_relay.h"

#include <algorithm>
#include <deque>
#include <memory>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace surfcast::testing {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kPacketBytes = 1448;      // payload of a TCP segment on Ethernet
constexpr int kReceiveBuffer = 16 * 1024;  // small, because bytes in it are an additional delay outside of LinkShape
constexpr std::chrono::milliseconds kStopCheck{50};

sockaddr_in loopback(uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

void set_option(int socket, int level, int option, int value) {
  ::setsockopt(socket, level, option, &value, sizeof value);
}

/// Two sockets shared by both directions; closed when both have ended.
struct Pair {
  int client;
  int server;
  Pair(int a, int b) : client(a), server(b) {}
  ~Pair() {
    ::close(client);
    ::close(server);
  }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
};

struct Packet {
  Clock::time_point arrival;
  std::vector<char> bytes;
};

/// One direction of the link: bytes are sent at the link's bandwidth and arrive after its delay.
class Line {
 public:
  Line(int from, int to, const LinkShape& shape, const std::atomic<double>& bits_per_second)
      : from_(from), to_(to), shape_(shape), bits_per_second_(bits_per_second) {}

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested() && (open_ || !packets_.empty())) {
      wait();
      if (!deliver()) break;
    }
    ::shutdown(to_, SHUT_WR);
    if (open_) ::shutdown(from_, SHUT_RD);
  }

 private:
  /// Waits until a packet is due or, if the queue has room, reads the next one.
  void wait() {
    const Clock::time_point now = Clock::now();
    const bool room = open_ && free_at_ <= now + shape_.queue;
    Clock::time_point until = now + kStopCheck;
    if (!packets_.empty()) until = std::min(until, packets_.front().arrival);
    if (open_ && !room) until = std::min(until, free_at_ - shape_.queue);
    pollfd watched{room ? from_ : -1, POLLIN, 0};
    const auto left = std::max(std::chrono::nanoseconds(0), std::chrono::nanoseconds(until - now)).count();
    const timespec timeout{left / 1'000'000'000, left % 1'000'000'000};
    if (::ppoll(&watched, 1, &timeout, nullptr) > 0) read_packet();
  }

  void read_packet() {
    std::vector<char> bytes(kPacketBytes);
    const ssize_t count = ::recv(from_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count <= 0) {
      open_ = false;
      return;
    }
    bytes.resize(static_cast<size_t>(count));
    const std::chrono::duration<double> on_line(static_cast<double>(count) * 8 / bits_per_second_);
    free_at_ = std::max(free_at_, Clock::now()) + std::chrono::duration_cast<Clock::duration>(on_line);
    packets_.push_back({free_at_ + shape_.delay, std::move(bytes)});
  }

  /// Sends the packets that are due. False when the receiver has closed the connection.
  bool deliver() {
    while (!packets_.empty() && packets_.front().arrival <= Clock::now()) {
      const std::vector<char>& bytes = packets_.front().bytes;
      for (size_t sent = 0; sent < bytes.size();) {
        const ssize_t count = ::send(to_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (count <= 0) return false;
        sent += static_cast<size_t>(count);
      }
      packets_.pop_front();
    }
    return true;
  }

  int from_;
  int to_;
  LinkShape shape_;
  const std::atomic<double>& bits_per_second_;
  std::deque<Packet> packets_;
  Clock::time_point free_at_ = Clock::now();
  bool open_ = true;
};

}  // namespace

LinkRelay::LinkRelay(uint16_t target, const LinkShape& shape, uint16_t port)
    : target_(target),
      shape_(shape),
      bits_per_second_(std::make_shared<std::atomic<double>>(shape.bits_per_second)),
      listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  set_option(listener_, SOL_SOCKET, SO_REUSEADDR, 1);
  set_option(listener_, SOL_SOCKET, SO_RCVBUF, kReceiveBuffer);
  sockaddr_in address = loopback(port);
  ::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address);
  ::listen(listener_, 64);
  socklen_t size = sizeof address;
  ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  acceptor_ = std::jthread([this](const std::stop_token& stop) { accept_all(stop); });
}

LinkRelay::~LinkRelay() {
  acceptor_.request_stop();
  ::shutdown(listener_, SHUT_RDWR);
  acceptor_.join();
  ::close(listener_);
  for (std::jthread& line : lines_) line.request_stop();
}

void LinkRelay::accept_all(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client >= 0) carry(client);
  }
}

void LinkRelay::carry(int client) {
  const int server = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  set_option(server, SOL_SOCKET, SO_RCVBUF, kReceiveBuffer);
  const auto pair = std::make_shared<Pair>(client, server);
  const sockaddr_in address = loopback(target_);
  if (::connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return;
  for (const int socket : {client, server}) set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  const auto start = [this, pair](int from, int to) {
    lines_.emplace_back([pair, from, to, shape = shape_, bits = bits_per_second_](const std::stop_token& stop) {
      Line(from, to, shape, *bits).run(stop);
    });
  };
  start(client, server);
  start(server, client);
}

}  // namespace surfcast::testing
