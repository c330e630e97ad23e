#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

namespace surfcast {

/// How many lines of one kind may come into a log: strangers decide how many there would be.
class LogLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// `lines` a minute; 0: any number.
  explicit LogLimit(size_t lines) : lines_(lines) {}

  /// Whether a line may be written now: nothing if not, else how many before it were left out.
  std::optional<size_t> admit(Clock::time_point now) {
    if (lines_ == 0) return 0;
    if (now - since_ >= std::chrono::minutes(1)) {
      since_ = now;
      written_ = 0;
    }
    if (written_ == lines_) {
      ++left_out_;
      return std::nullopt;
    }
    ++written_;
    const size_t left_out = left_out_;
    left_out_ = 0;
    return left_out;
  }

 private:
  size_t lines_;
  size_t written_ = 0;  ///< in the minute that began at `since_`
  size_t left_out_ = 0;
  Clock::time_point since_{};
};

}  // namespace surfcast
