#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "geometry/box.h"
#include "surfel/grid.h"
#include "surfel/scalar_attribute.h"

namespace surfcast::surfel {

/// Per-point colours in the depth of their source, sRGB encoded; `bits` is 8 (0 to 255) or 16 (0 to 65535).
struct ColorAttribute {
  int bits = 8;
  std::vector<glm::u16vec3> values;
};

/// A run of surfels that came from one input file.
struct SourceRange {
  std::string name;          ///< file name without its folders
  size_t first = 0;          ///< index of the run's first surfel
  size_t count = 0;          ///< surfels of the run
  std::optional<Grid> grid;  ///< the lattice all its positions lie on, where the format has one
};

/// A surface sampled by oriented discs (surfels): structure of arrays, all of one length. Optional attributes are
/// empty where the scan has none.
struct SurfelCloud {
  std::vector<glm::dvec3> positions;  ///< world coordinates of the source
  std::vector<glm::vec3> normals;     ///< unit
  std::vector<float> radii;           ///< world units; the mean distance to the six nearest neighbours when estimated
  std::vector<float> weights;         ///< per-surfel normalisation weights s_k (Ren 2002, section 7)
  std::optional<ColorAttribute> colors;
  std::vector<ScalarAttribute> scalars;
  std::vector<SourceRange> sources;  ///< in order, covering every surfel
  bool estimated_normals = false;    ///< no source has normals: they are exact to some degrees
  bool estimated_radii = false;      ///< no source has radii
  bool oriented = false;             ///< normals point out of the surface (or towards the sensor), so back faces exist
  bool z_up = true;                  ///< the vertical axis is z (surveying); otherwise y (graphics)

  [[nodiscard]] size_t size() const { return positions.size(); }
  [[nodiscard]] geometry::Box bounds() const;
};

}  // namespace surfcast::surfel
