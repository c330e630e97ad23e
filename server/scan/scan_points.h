#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "geometry/box.h"
#include "surfel/grid.h"
#include "surfel/scalar_attribute.h"
#include "surfel/surfel_cloud.h"

namespace surfcast {

/// The points of one input file as its format states them, nothing dropped or estimated yet. Structure of arrays;
/// attributes that the file does not have are empty.
struct ScanPoints {
  std::string name;                   ///< file name without its folders
  std::vector<glm::dvec3> positions;  ///< world coordinates; may hold NaN and infinities
  std::optional<Grid> grid;           ///< the lattice all positions lie on, where the format has one (LAS)
  std::vector<glm::vec3> normals;     ///< as stored: any length, perhaps zero
  std::vector<float> radii;           ///< world units
  std::optional<ColorAttribute> colors;
  std::vector<ScalarAttribute> scalars;
  std::optional<glm::dvec3> sensor;  ///< where the scanner stood, when the file says so
  bool z_up = true;                  ///< LAS and text surveys are z-up; see each reader

  [[nodiscard]] size_t size() const { return positions.size(); }
};

/// The bounds of the points whose coordinates are all finite.
Box finite_bounds(const std::vector<glm::dvec3>& positions);

}  // namespace surfcast
