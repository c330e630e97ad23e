#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <thread>
#include <vector>

namespace surfcast::testing {

/// The properties of an emulated network link, equal in both directions.
struct LinkShape {
  double bits_per_second = 4e6;
  std::chrono::microseconds delay{40'000};  ///< one way
  std::chrono::microseconds queue{20'000};  ///< transmission time of the sender's queue; a full queue reads no more
};

/// A TCP relay on the loopback interface that emulates such a link to a port. It needs neither privileges nor the
/// kernel's traffic control.
class LinkRelay {
 public:
  /// Listens on `port` (0: any) and connects to `target`.
  LinkRelay(uint16_t target, const LinkShape& shape, uint16_t port = 0);
  ~LinkRelay();
  LinkRelay(const LinkRelay&) = delete;
  LinkRelay& operator=(const LinkRelay&) = delete;

  [[nodiscard]] uint16_t port() const { return port_; }
  /// The rate from now on, in all connections. May be called from any thread.
  void set_bits_per_second(double bits) { *bits_per_second_ = bits; }

 private:
  void accept_all(const std::stop_token& stop);
  void carry(int client);

  uint16_t target_;
  LinkShape shape_;  ///< but for its rate
  std::shared_ptr<std::atomic<double>> bits_per_second_;
  int listener_;
  uint16_t port_ = 0;
  std::vector<std::jthread> lines_;
  std::jthread acceptor_;  ///< the only thread that accesses lines_ while it runs
};

}  // namespace surfcast::testing
