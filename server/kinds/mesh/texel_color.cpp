#include "mesh/texel_color.h"

#include <cmath>

#include "surfel/srgb.h"

namespace surfcast::mesh {
namespace {

/// Texels along an axis and their weights: ends count in full where whole texels are covered.
struct Taps {
  int64_t first = 0;
  int64_t count = 1;
  double second = 0;  ///< weight of the second of two texels, between which the texture is linear

  [[nodiscard]] double weight(int64_t tap) const {
    if (second < 0) return 1;
    return tap == 0 ? 1 - second : second;
  }
};

Taps taps_of(double centre, double size) {
  if (size >= 1) {
    const auto count = static_cast<int64_t>(std::llround(size));
    return {std::llround(centre - static_cast<double>(count) / 2), count, -1};
  }
  const double first = std::floor(centre - 0.5);
  return {static_cast<int64_t>(first), 2, centre - 0.5 - first};
}

/// Sums of light times alpha, of alpha, and of weights.
struct Sums {
  glm::dvec3 light{0};
  double alpha = 0;
  double weight = 0;

  void add(const glm::vec4& texel, double w) {
    light += w * double{texel.a} * glm::dvec3(texel);
    alpha += w * double{texel.a};
    weight += w;
  }
  [[nodiscard]] glm::vec4 mean() const {
    if (!(weight > 0 && alpha > 0)) return glm::vec4(0);
    return {glm::vec3(light / alpha), static_cast<float>(alpha / weight)};
  }
};

}  // namespace

glm::vec4 texel_light(const Texture& texture, int64_t x, int64_t y, bool opaque) {
  const auto& [r, g, b, a] = texture.at(x, y);
  return {surfel::to_linear({r, g, b}, 8), opaque ? 1.0F : static_cast<float>(a) / 255.0F};
}

glm::vec4 mean_light(const Texture& texture, const TexelArea& area, const std::array<Wrap, 2>& wrap, bool opaque,
                     const ChartMap* charts, uint32_t chart) {
  const Taps across = taps_of(area.centre.x, area.size.x);
  const Taps down = taps_of(area.centre.y, area.size.y);
  Sums all;
  Sums own;
  for (int64_t j = 0; j < down.count; ++j) {
    const int64_t y = wrapped(down.first + j, texture.height, wrap[1]);
    for (int64_t i = 0; i < across.count; ++i) {
      const int64_t x = wrapped(across.first + i, texture.width, wrap[0]);
      const glm::vec4 texel = texel_light(texture, x, y, opaque);
      const double weight = across.weight(i) * down.weight(j);
      all.add(texel, weight);
      if (charts != nullptr && charts->holds(x, y, chart)) own.add(texel, weight);
    }
  }
  return own.weight > 0 ? own.mean() : all.mean();
}

}  // namespace surfcast::mesh
