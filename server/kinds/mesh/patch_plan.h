#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "mesh/cell_lattice.h"
#include "mesh/mesh.h"
#include "mesh/placed_triangle.h"

namespace surfcast::mesh {

/// How densely a patch is sampled: the same for all of it, because a wide kernel beside narrow ones would cover them.
struct PatchPlan {
  double texels_per_cell = 1;  ///< along each axis, a power of two
  double spacing = 0;          ///< of the triangles without usable texture coordinates, world units
  double coarsest = 0;         ///< world size of a texel beyond which texture coordinates are not usable
};

/// What decides the density of a patch.
struct PatchFacts {
  double area = 0;  ///< world
  uint64_t triangles = 0;
  double texels = 0;  ///< covered by triangles; 0 without a texture
  double bend = 0;    ///< radians by which normals turn within a unit of length, on all but a tenth of the area

  /// World size of a texel.
  [[nodiscard]] double texel() const { return texels > 0 ? std::sqrt(area / texels) : 0; }
};

/// `size`: texels of its texture; none without.
[[nodiscard]] PatchFacts facts_of(const Patch& patch, const std::optional<glm::ivec2>& size);

/// `usual`: the spacing of surfaces without texture. `wanted`: the spacing asked for.
[[nodiscard]] PatchPlan plan_patch(const PatchFacts& facts, double usual, std::optional<double> wanted);

/// Surfels of a patch, nearly.
[[nodiscard]] double expected_surfels(const PatchFacts& facts, const PatchPlan& plan);

/// A triangle on the cells in which it gets surfels.
struct CellPlane {
  std::array<glm::dvec2, 3> cells{};
  glm::dvec2 texels_per_cell{0};  ///< 0 where cells are not those of a texture
};

/// Cells of the texture, or of a plane in the world that is nearly parallel to the triangle: neighbours on a smooth
/// surface mostly share it. `corners`: in texels, if there is a texture.
[[nodiscard]] CellPlane cells_of(const PlacedTriangle& triangle,
                                 const std::optional<std::array<glm::dvec2, 3>>& corners, const PatchPlan& plan);

}  // namespace surfcast::mesh
