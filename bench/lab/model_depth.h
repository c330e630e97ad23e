#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "lab/leave_out.h"
#include "model/model_file.h"

namespace surfcast::lab {

/// The surfels of the finest level as they are drawn and picked.
struct DrawnSurfels {
  std::vector<glm::dvec3> positions;  ///< world
  std::vector<glm::dvec3> normals;    ///< unit
  std::vector<double> radii;          ///< world units, limited as in pictures
  std::vector<uint8_t> scatter;       ///< 1: faces the eye (SurfelCloud::scatter); empty without scatter
  bool oriented = false;              ///< back faces are not drawn
};

/// Decodes the leaves of a model of surfels. Fails on a damaged block.
Result<DrawnSurfels> drawn_surfels(const model::ModelFile& model);

/// The depths of a picture of the finest level: in each pixel the depth that a pick of the pixel's centre finds (the
/// opaque discs of kinds/opaque_disc.h in double precision), rounded to 32 bits.
DepthPicture model_depths(const DrawnSurfels& surfels, const geometry::CameraFrame& frame);

}  // namespace surfcast::lab
