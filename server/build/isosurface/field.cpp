#include "isosurface/field.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace surfcast::isosurface {
namespace {

/// The weights of four neighbouring samples along an axis, and their derivatives.
struct Taps {
  int64_t first = 0;  ///< the place of the first one; may lie beyond the face
  std::array<double, 4> weights{};
  std::array<double, 4> slopes{};
};

/// The last sample has no cell behind it and belongs to the cell before.
Taps taps_at(double place, int64_t size) {
  const auto cell = std::clamp<int64_t>(static_cast<int64_t>(std::floor(place)), 0, std::max<int64_t>(size - 2, 0));
  const double t = place - static_cast<double>(cell);
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {cell - 1,
          {0.5 * (-t + 2 * t2 - t3), 0.5 * (2 - 5 * t2 + 3 * t3), 0.5 * (t + 4 * t2 - 3 * t3), 0.5 * (t3 - t2)},
          {0.5 * (-1 + 4 * t - 3 * t2), 0.5 * (-10 * t + 9 * t2), 0.5 * (1 + 8 * t - 9 * t2), 0.5 * (3 * t2 - 2 * t)}};
}

/// The sum over a row, and its derivative along it.
struct RowSum {
  double value = 0;
  double slope = 0;
};

RowSum sum_row(std::span<const double> row, const Taps& taps) {
  RowSum sum;
  const auto last = static_cast<int64_t>(row.size()) - 1;
  for (size_t a = 0; a < 4; ++a) {
    const double sample = row[static_cast<size_t>(std::clamp<int64_t>(taps.first + static_cast<int64_t>(a), 0, last))];
    sum.value += taps.weights[a] * sample;
    sum.slope += taps.slopes[a] * sample;
  }
  return sum;
}

}  // namespace

FieldValue field_at(const SampleWindow& samples, const glm::dvec3& place) {
  const Taps i = taps_at(place.x, samples.size().x);
  const Taps j = taps_at(place.y, samples.size().y);
  const Taps k = taps_at(place.z, samples.size().z);
  FieldValue field;
  for (size_t c = 0; c < 4; ++c) {
    for (size_t b = 0; b < 4; ++b) {
      const RowSum row = sum_row(samples.row(j.first + static_cast<int64_t>(b), k.first + static_cast<int64_t>(c)), i);
      const double weight = j.weights[b] * k.weights[c];
      field.value += weight * row.value;
      field.gradient += glm::dvec3(weight * row.slope, j.slopes[b] * k.weights[c] * row.value,
                                   j.weights[b] * k.slopes[c] * row.value);
    }
  }
  return field;
}

}  // namespace surfcast::isosurface
