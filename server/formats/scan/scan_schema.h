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

/// The attributes of the points of a scan, known before any point is read.
struct ScanSchema {
  std::string name;                  ///< file name without its folders
  std::optional<surfel::Grid> grid;  ///< the lattice of all positions, if the format has one (LAS)
  bool normals = false;
  bool radii = false;
  int color_bits = 0;  ///< of each channel: 8 or 16; 0 without colour
  std::vector<ScalarField> scalars;
  std::optional<glm::dvec3> sensor;  ///< scanner position, if the file states it
  /// Set if every point is known to lie on a surface whose normal it states, out of the solid: about the largest
  /// distance of neighbouring points there, world units.
  std::optional<double> surface_step;
  bool exact_radii = false;  ///< radii are those that the kernel needs, so that they are not compared with the spacing
  bool two_sided = false;    ///< some surfaces have no back
  std::string crs;           ///< coordinate system: WKT or "EPSG:code"; empty if the file does not state one
  std::vector<std::string> notes;  ///< what is left out of the file, for people
  bool z_up = true;                ///< true for LAS and text surveys; see each reader
};

}  // namespace surfcast::scan
