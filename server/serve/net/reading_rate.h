#pragma once

#include <chrono>
#include <cstddef>

namespace surfcast::net {

/// Whether a client takes its answers fast enough: so many bytes a second, on average over each window. Without it a
/// byte now and then would keep an answer in memory for ever.
class ReadingRate {
 public:
  using Clock = std::chrono::steady_clock;

  /// `least` 0: any rate will do.
  ReadingRate(std::chrono::milliseconds window, size_t least, Clock::time_point now)
      : window_(window), least_(least), begin_(now) {}

  void take(size_t bytes) { taken_ += bytes; }
  /// To be asked now and then, while there is something to take.
  bool is_too_slow(Clock::time_point now) {
    if (now < begin_ + window_) return false;
    const double seconds = std::chrono::duration<double>(now - begin_).count();
    const bool slow = static_cast<double>(taken_) < static_cast<double>(least_) * seconds;
    begin_ = now;
    taken_ = 0;
    return slow;
  }

 private:
  std::chrono::milliseconds window_;
  size_t least_;
  Clock::time_point begin_;
  size_t taken_ = 0;
};

}  // namespace surfcast::net
