#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surfel/surfel_cloud.h"

namespace surfcast::ldc {

/// A surfel on its way through the levels: of the source, or an average of several. Colour stays linear and intensity
/// unrounded until a level is stored, so that no level adds its rounding to the next.
struct CoarseSurfel {
  glm::dvec3 position{0};
  glm::vec3 normal{0, 0, 1};  ///< unit
  float radius = 1;           ///< world units; its square is in proportion to the area it stands for
  glm::vec3 light{0};         ///< linear, in [0, 1]; 0 without colour
  double intensity = 0;
  double classification = 0;
};

/// The attributes that the coarse surfels of a model have.
struct CoarseAttributes {
  bool oriented = false;
  bool z_up = true;
  int color_bits = 0;                            ///< 0 without colour
  std::vector<surfel::ScalarAttribute> scalars;  ///< names and types in the order of the model, without values
};

CoarseAttributes coarse_attributes(const surfel::SurfelCloud& cloud);

/// Some surfels of a cloud as they are, but none with a radius above `largest`.
std::vector<CoarseSurfel> sample_surfels(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members,
                                         float largest);

/// Coarse surfels as a cloud, in their order. Weights are left to be found.
surfel::SurfelCloud make_coarse_cloud(std::span<const CoarseSurfel> surfels, const CoarseAttributes& attributes);

}  // namespace surfcast::ldc
