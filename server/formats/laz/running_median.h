#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace surfcast::laz {

/// An estimate of the median of recent values: five sorted values, in which a new value replaces the largest or the
/// smallest. All are zero initially.
class RunningMedian {
 public:
  [[nodiscard]] int32_t get() const { return sorted_[2]; }

  void add(int32_t value) {
    const int32_t median = get();
    sorted_ = inserted(drop_largest_ ? 0 : 1, value);
    drop_largest_ = drop_largest_ ? value < median : value <= median;
  }

 private:
  using Values = std::array<int32_t, 5>;

  /// The four values from `kept` on and `value`, sorted. Minima and maxima avoid branches that would be mispredicted.
  [[nodiscard]] Values inserted(size_t kept, int32_t value) const {
    const int32_t* four = &sorted_[kept];
    Values values;
    values[0] = std::min(four[0], value);
    for (size_t i = 1; i < 4; ++i) values[i] = std::max(four[i - 1], std::min(four[i], value));
    values[4] = std::max(four[3], value);
    return values;
  }

  Values sorted_{};
  bool drop_largest_ = true;
};

}  // namespace surfcast::laz
