#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "scan_scene.h"

namespace surfcast::bench {

inline uint64_t mix(uint64_t h) {
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
  return h ^ (h >> 31);
}

/// Deterministic random numbers: equal seeds give equal sequences.
class Dice {
 public:
  explicit Dice(uint64_t seed) : state_(mix(seed + 0x9e3779b97f4a7c15ULL)) {}

  double uniform() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return static_cast<double>(mix(state_) >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * uniform(); }
  double gaussian() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  uint64_t state_;
};

inline double lattice_value(int64_t x, int64_t y) {
  return static_cast<double>(mix(static_cast<uint64_t>(x) * 0x8da6b343 ^ static_cast<uint64_t>(y) * 0xd8163841) >> 11) *
         0x1p-53;
}

/// Smooth noise in [0, 1] with features of size 1.
inline double noise(const glm::dvec2& p) {
  const glm::dvec2 cell = glm::floor(p);
  const glm::dvec2 f = p - cell;
  const glm::dvec2 t = f * f * (3.0 - 2.0 * f);
  const auto x = static_cast<int64_t>(cell.x);
  const auto y = static_cast<int64_t>(cell.y);
  return glm::mix(glm::mix(lattice_value(x, y), lattice_value(x + 1, y), t.x),
                  glm::mix(lattice_value(x, y + 1), lattice_value(x + 1, y + 1), t.x), t.y);
}

/// Gives an echo a colour that varies by a share `grain`, and its intensity.
inline void paint(Echo& echo, const glm::dvec3& color, double grain, Dice& dice) {
  const glm::dvec3 c = glm::clamp(color * (1 + grain * dice.gaussian()), 0.0, 1.0);
  echo.color = glm::u16vec3(c * 65535.0 + 0.5);
  const double bright = 0.3 * c.x + 0.6 * c.y + 0.1 * c.z;
  echo.intensity = static_cast<uint16_t>(std::clamp(40000 * bright + 1500 * dice.gaussian(), 1.0, 65535.0));
}

}  // namespace surfcast::bench
