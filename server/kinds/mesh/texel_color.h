#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "mesh/chart_map.h"
#include "mesh/texture.h"

namespace surfcast::mesh {

/// A part of a texture: a rectangle of texels, or less than one.
struct TexelArea {
  glm::dvec2 centre{0};  ///< texel (i, j) has its centre at (i + 1/2, j + 1/2)
  glm::dvec2 size{1};    ///< texels along each axis
};

/// Linear light and alpha of a texel; alpha is 1 if it is to be ignored.
[[nodiscard]] glm::vec4 texel_light(const Texture& texture, int64_t x, int64_t y, bool opaque);

/// The mean over an area in linear light, weighted by alpha: whole texels where it is larger than one, else the
/// bilinear texture at its centre. `charts`: leave out texels that are not of `chart`, unless none is.
[[nodiscard]] glm::vec4 mean_light(const Texture& texture, const TexelArea& area, const std::array<Wrap, 2>& wrap,
                                   bool opaque, const ChartMap* charts, uint32_t chart);

}  // namespace surfcast::mesh
