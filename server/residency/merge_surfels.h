#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace surfcast::residency {

/// A surfel of a block, or the mean of several.
struct MergedSurfel {
  glm::vec3 position{0};        ///< world units, from the corner of the block
  glm::vec3 normal{0, 0, 1};    ///< unit
  float radius = 1;             ///< world units; its square is in proportion to the area it stands for
  float weight = 0;             ///< normalisation weight s_k
  glm::vec3 light{0};           ///< linear
  uint32_t representative = 0;  ///< of the surfels that it was merged from, the one of the largest area
};

/// One surfel each for two (first != second) or one of the level below.
struct MergedFrom {
  uint32_t first = 0;
  uint32_t second = 0;
  [[nodiscard]] bool pair() const { return first != second; }
};

/// What stands next to each other along the curve, close together and facing the same way, becomes one. A level of
/// detail between those of the LDC tree, half as dense as its input: coarse enough, the area and so the radius of what
/// is merged adds up, and the relation of radius and distance, with it the weight, stays what it was.
struct MergedLevel {
  std::vector<MergedSurfel> surfels;  ///< along the curve
  std::vector<MergedFrom> from;       ///< for each of them
};

/// `surfels` lie along a space filling curve. Without a front and a back (`oriented`) normals may be turned around.
MergedLevel merge_surfels(std::span<const MergedSurfel> surfels, bool oriented);

}  // namespace surfcast::residency
