#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "laz/integer_decoder.h"
#include "laz/running_median.h"

namespace surfcast::laz {

/// Decodes X, Y and Z of a point. The size of the correction of one coordinate is the context of the next. X and Y are
/// predicted by the median of their recent steps, separately for each of `kStepContexts`; Z by the last height of a
/// return on the same level.
template <size_t kStepContexts>
class CoordinateDecoder {
 public:
  explicit CoordinateDecoder(int32_t first_height) { heights_.fill(first_height); }

  int32_t x_step(ArithmeticDecoder& in, uint32_t step_context, bool single) {
    const int32_t step = x_.decode(in, x_steps_[step_context].get(), single);
    x_steps_[step_context].add(step);
    return step;
  }

  int32_t y_step(ArithmeticDecoder& in, uint32_t step_context, bool single) {
    const uint32_t context = even(std::min(x_.size(), 20U)) + single;
    const int32_t step = y_.decode(in, y_steps_[step_context].get(), context);
    y_steps_[step_context].add(step);
    return step;
  }

  int32_t z(ArithmeticDecoder& in, uint32_t level, bool single) {
    const uint32_t context = even(std::min((x_.size() + y_.size()) / 2, 18U)) + single;
    return heights_[level] = z_.decode(in, heights_[level], context);
  }

 private:
  static uint32_t even(uint32_t number) { return number & ~1U; }

  std::array<RunningMedian, kStepContexts> x_steps_;
  std::array<RunningMedian, kStepContexts> y_steps_;
  std::array<int32_t, 8> heights_;
  IntegerDecoder<32, 2> x_;
  IntegerDecoder<32, 22> y_;
  IntegerDecoder<32, 20> z_;
};

/// The sum modulo 2^32, as LASzip computes all coordinates.
constexpr int32_t wrapping_sum(int32_t a, int32_t b) {
  return static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
}

}  // namespace surfcast::laz
