#include "ldc/lattice.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace surfcast::ldc {
namespace {

/// Exponent k of the largest 2^k not above x > 0.
int floor_log2(double x) {
  return std::ilogb(x);
}

double largest_magnitude(const geometry::Box& box) {
  const glm::dvec3 m = glm::max(glm::abs(box.min), glm::abs(box.max));
  return std::max({m.x, m.y, m.z});
}

}  // namespace

surfel::Grid choose_lattice(const geometry::Box& box, double max_error) {
  // Rounding to a cubic lattice of step h moves a point by at most h sqrt(3) / 2.
  const int wanted = floor_log2(2 * max_error / std::numbers::sqrt3);
  const double magnitude = largest_magnitude(box);
  const int finest_double = magnitude > 0 ? std::max(floor_log2(magnitude) - 52, -1074) : -1074;
  return {glm::dvec3(std::ldexp(1.0, std::max(wanted, finest_double))), glm::dvec3(0)};
}

bool indices_fit(const surfel::Grid& grid, const geometry::Box& box, size_t count) {
  const glm::i64vec3 extent = grid.index(box.max) - grid.index(box.min);
  const int64_t limit = int64_t{1} << (count < kDenseBlockSurfels ? kMaxIndexBits : kIndexBits);
  return extent.x < limit && extent.y < limit && extent.z < limit;
}

}  // namespace surfcast::ldc
