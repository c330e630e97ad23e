#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "geometry/box.h"
#include "surfel/grid.h"
#include "surfel/scalar_attribute.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::scan {

/// Some points of one input file as stored, before cleaning and estimation. Structure of arrays; attributes that the
/// file does not have are empty.
struct ScanPoints {
  std::vector<glm::dvec3> positions;  ///< world coordinates; may hold NaN and infinities
  std::vector<glm::vec3> normals;     ///< as stored: of any length, may be zero
  std::vector<float> radii;           ///< world units
  std::optional<surfel::ColorAttribute> colors;
  std::vector<surfel::ScalarAttribute> scalars;

  [[nodiscard]] size_t size() const { return positions.size(); }
};

}  // namespace surfcast::scan
