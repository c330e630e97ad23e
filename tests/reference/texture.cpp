#include "reference/texture.h"

#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <numbers>

namespace surfcast::reference {
namespace {

/// Uniform in [0, 1), a hash of the lattice point (the finaliser of SplitMix64).
double lattice_noise(int64_t x, int64_t y, uint64_t channel) {
  uint64_t h =
      static_cast<uint64_t>(x) * 0x9E3779B97F4A7C15U + static_cast<uint64_t>(y) * 0xD1B54A32D192ED03U + channel;
  h = (h ^ (h >> 30U)) * 0xBF58476D1CE4E5B9U;
  h = (h ^ (h >> 27U)) * 0x94D049BB133111EBU;
  return static_cast<double>((h ^ (h >> 31U)) >> 11U) * 0x1.0p-53;
}

glm::dvec3 lattice_color(int64_t x, int64_t y) {
  return {lattice_noise(x, y, 1), lattice_noise(x, y, 2), lattice_noise(x, y, 3)};
}

double wave(const glm::dvec2& uv, double a, double b, double phase) {
  return 0.5 + 0.4 * std::sin(2 * std::numbers::pi * (a * uv.x + b * uv.y) + phase);
}

}  // namespace

Texture one_color(const glm::dvec3& color) {
  return [color](const glm::dvec2&) { return color; };
}

Texture checker(int columns, int rows, const glm::dvec3& a, const glm::dvec3& b) {
  return [=](const glm::dvec2& uv) {
    const auto parity =
        static_cast<int64_t>(std::floor(uv.x * columns)) + static_cast<int64_t>(std::floor(uv.y * rows));
    return parity % 2 == 0 ? a : b;
  };
}

Texture sines() {
  return
      [](const glm::dvec2& uv) { return glm::dvec3(wave(uv, 3, 1, 0.0), wave(uv, -2, 5, 1.0), wave(uv, 6, 4, 2.0)); };
}

Texture value_noise(int cells) {
  return [cells](const glm::dvec2& uv) {
    const glm::dvec2 p = uv * static_cast<double>(cells);
    const glm::dvec2 corner = glm::floor(p);
    const glm::dvec2 f = p - corner;
    const auto x = static_cast<int64_t>(corner.x);
    const auto y = static_cast<int64_t>(corner.y);
    return glm::mix(glm::mix(lattice_color(x, y), lattice_color(x + 1, y), f.x),
                    glm::mix(lattice_color(x, y + 1), lattice_color(x + 1, y + 1), f.x), f.y);
  };
}

Texture step_edge(const glm::dvec3& a, const glm::dvec3& b) {
  return [=](const glm::dvec2& uv) { return (uv.x - 0.5) + 0.3 * (uv.y - 0.5) < 0 ? a : b; };
}

}  // namespace surfcast::reference
