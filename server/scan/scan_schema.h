#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scan/scalar_type.h"
#include "surfel/grid.h"

namespace surfcast::scan {

struct ScalarField {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  bool operator==(const ScalarField&) const = default;
};

/// What the points of a scan have, known before any of them is delivered.
struct ScanSchema {
  std::string name;                  ///< file name without its folders
  std::optional<surfel::Grid> grid;  ///< the lattice all positions lie on, where the format has one (LAS)
  bool normals = false;
  bool radii = false;
  int color_bits = 0;  ///< of each channel: 8 or 16; 0 without colour
  std::vector<ScalarField> scalars;
  std::optional<glm::dvec3> sensor;  ///< where the scanner stood, when the file says so
  bool z_up = true;                  ///< LAS and text surveys are z-up; see each reader
};

}  // namespace surfcast::scan
