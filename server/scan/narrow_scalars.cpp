#include "scan/narrow_scalars.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace surfcast {
namespace {

struct Range {
  double min = 0;
  double max = 0;
  bool integers = true;
};

Range range_of(const std::vector<double>& values) {
  Range range;
  for (const double v : values) {
    range.integers = range.integers && std::trunc(v) == v;  // false for NaN
    range.min = std::min(range.min, v);
    range.max = std::max(range.max, v);
  }
  return range;
}

template <typename T>
bool narrow_to(const Range& range, const std::vector<double>& values, ScalarValues& narrowed) {
  using Limits = std::numeric_limits<T>;
  if (!range.integers || range.min < Limits::min() || range.max > Limits::max()) return false;
  std::vector<T> typed(values.size());
  std::transform(values.begin(), values.end(), typed.begin(), [](double v) { return static_cast<T>(v); });
  narrowed = std::move(typed);
  return true;
}

}  // namespace

ScalarValues narrow_scalars(ScalarValues values) {
  const auto* doubles = std::get_if<std::vector<double>>(&values);
  if (doubles == nullptr) return values;
  const Range range = range_of(*doubles);
  ScalarValues narrowed;
  const bool fits = narrow_to<uint8_t>(range, *doubles, narrowed) || narrow_to<int8_t>(range, *doubles, narrowed) ||
                    narrow_to<uint16_t>(range, *doubles, narrowed) || narrow_to<int16_t>(range, *doubles, narrowed) ||
                    narrow_to<uint32_t>(range, *doubles, narrowed) || narrow_to<int32_t>(range, *doubles, narrowed);
  return fits ? std::move(narrowed) : std::move(values);
}

}  // namespace surfcast
