#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace surfcast::laz {

/// An estimate of the median of the last few values: five sorted values, of which each new one pushes out the largest
/// and the smallest in turn. All are zero at first.
class RunningMedian {
 public:
  [[nodiscard]] int32_t get() const { return sorted_[2]; }

  void add(int32_t value) { drop_largest_ ? add_from_below(value) : add_from_above(value); }

 private:
  void add_from_below(int32_t value) {
    drop_largest_ = value < sorted_[2];
    size_t at = 4;
    for (; at > 0 && value < sorted_[at - 1]; --at) sorted_[at] = sorted_[at - 1];
    sorted_[at] = value;
  }

  void add_from_above(int32_t value) {
    drop_largest_ = value <= sorted_[2];
    size_t at = 0;
    for (; at < 4 && value > sorted_[at + 1]; ++at) sorted_[at] = sorted_[at + 1];
    sorted_[at] = value;
  }

  std::array<int32_t, 5> sorted_{};
  bool drop_largest_ = true;
};

}  // namespace surfcast::laz
