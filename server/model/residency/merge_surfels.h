#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace surfcast::residency {

/// A surfel of a block, or the mean of several surfels.
struct MergedSurfel {
  glm::vec3 position{0};        ///< world units, relative to the corner of the block
  glm::vec3 normal{0, 0, 1};    ///< unit
  float radius = 1;             ///< world units; its square is proportional to the area that the surfel stands for
  float weight = 0;             ///< normalisation weight s_k
  glm::vec3 light{0};           ///< linear, not multiplied by the opacity
  uint32_t representative = 0;  ///< the surfel of the largest area among those that it was merged from
  bool scatter = false;         ///< lies on no surface, as all surfels that it was merged from
  float opacity = 1;            ///< share of the light behind it that it hides, in [0, 1]
};

/// The one or two surfels of the finer level from which a surfel was made; first != second for two.
struct MergedFrom {
  uint32_t first = 0;
  uint32_t second = 0;
  [[nodiscard]] bool pair() const { return first != second; }
};

/// A level of detail between those of the LDC tree, about half as dense as its input. Neighbours along the curve that
/// are close together and face the same way are merged to one surfel. Areas add up, so radii grow in proportion to the
/// distances between surfels, and the weights stay valid. Scatter is merged with scatter alone, whatever its normals.
struct MergedLevel {
  std::vector<MergedSurfel> surfels;  ///< in the order of the curve
  std::vector<MergedFrom> from;       ///< origin of each of `surfels`
};

/// `surfels` are ordered along a space filling curve. Normals may be flipped if the surfels are not `oriented`.
MergedLevel merge_surfels(std::span<const MergedSurfel> surfels, bool oriented);

}  // namespace surfcast::residency
