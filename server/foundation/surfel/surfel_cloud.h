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

/// Per-point sRGB colours with the bit depth of their source. `bits` is 8 (values 0 to 255) or 16 (0 to 65535).
struct ColorAttribute {
  int bits = 8;
  std::vector<glm::u16vec3> values;
};

/// A run of surfels from one input file.
struct SourceRange {
  std::string name;          ///< file name without its folders
  size_t first = 0;          ///< index of the run's first surfel
  size_t count = 0;          ///< surfels of the run
  std::optional<Grid> grid;  ///< the lattice of all its positions, if the format has one
};

/// A surface sampled by oriented discs (surfels), as a structure of arrays of equal length. Optional attributes are
/// empty if the scan does not have them.
struct SurfelCloud {
  std::vector<glm::dvec3> positions;  ///< world coordinates of the source
  std::vector<glm::vec3> normals;     ///< unit
  std::vector<float> radii;           ///< world units; estimated ones follow scan/spacing.h
  std::vector<float> weights;         ///< per-surfel normalisation weights s_k (Ren 2002, section 7)
  /// 1 for scatter: points that lie on no surface and are drawn as round splats that face the eye, not as discs. Empty
  /// without scatter.
  std::vector<uint8_t> scatter;
  std::optional<ColorAttribute> colors;
  std::vector<ScalarAttribute> scalars;
  std::vector<SourceRange> sources;  ///< in order; they cover every surfel
  bool estimated_normals = false;    ///< no source has normals: they are accurate to a few degrees
  bool estimated_radii = false;      ///< no radius comes from a source
  bool oriented = false;             ///< normals point out of the surface or towards the sensor: back faces exist
  bool z_up = true;                  ///< the vertical axis is z (surveying); otherwise y (graphics)

  [[nodiscard]] size_t size() const { return positions.size(); }
  [[nodiscard]] bool is_scatter(size_t i) const { return !scatter.empty() && scatter[i] != 0; }
  [[nodiscard]] geometry::Box bounds() const;
};

}  // namespace surfcast::surfel
