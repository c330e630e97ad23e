#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surfel/surfel_cloud.h"

namespace surfcast::ldc {

/// A surfel during coarsening: one of the source, or an average of several. Colour stays linear and intensity unrounded
/// until a level is stored, so rounding errors do not accumulate over the levels.
struct CoarseSurfel {
  glm::dvec3 position{0};
  glm::vec3 normal{0, 0, 1};  ///< unit
  float radius = 1;           ///< world units; its square is proportional to the area that the surfel stands for
  glm::vec3 light{0};         ///< linear, in [0, 1], not multiplied by the opacity; 0 without colour
  float opacity = 1;          ///< share of the light behind it that it hides, in [0, 1]
  double intensity = 0;
  double classification = 0;
  bool scatter = false;  ///< lies on no surface, as all surfels that it stands for
};

/// The attributes of the coarse surfels of a model.
struct CoarseAttributes {
  bool oriented = false;
  bool z_up = true;
  int color_bits = 0;                            ///< 8 or 16; 0 without colour
  std::vector<surfel::ScalarAttribute> scalars;  ///< names and types in the order of the model, without values
};

CoarseAttributes coarse_attributes(const surfel::SurfelCloud& cloud);

/// A subset of the surfels of a cloud, unchanged except that the radii of discs are clamped to `largest`.
std::vector<CoarseSurfel> sample_surfels(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members,
                                         float largest);

/// Coarse surfels as a cloud, in the same order. The weights stay empty.
surfel::SurfelCloud make_coarse_cloud(std::span<const CoarseSurfel> surfels, const CoarseAttributes& attributes);

}  // namespace surfcast::ldc
