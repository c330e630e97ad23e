#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "isosurface/iso_surface.h"
#include "scan/row_source.h"

namespace surfcast::isosurface {

/// What became of the samples beside a surface, which are those with one of their six neighbours on the other side.
struct SurfaceReport {
  double value = 0;
  uint64_t points = 0;
  uint64_t thinned = 0;  ///< close to the point of another sample, mostly that on the other side
  uint64_t lost = 0;     ///< the field is flat there, or a sample around is not a number
};

/// The points of surfaces, as rows of a scan: place, normal (out of what is larger than the value), colour if a surface
/// has one, and the surface's value if there are several.
struct SurfaceRows {
  std::unique_ptr<scan::RowSource> rows;
  std::vector<SurfaceReport> reports;  ///< of each surface
};

/// Finds surfaces of a grid of scalars, which is read once. `memory`: bytes for its planes. The points are kept in a
/// temporary file beside `target`; they do not depend on `memory` or the number of threads. Fails where a surface has
/// no point, with the range of the samples.
Result<SurfaceRows> find_surfaces(const std::filesystem::path& grid, std::span<const IsoSurface> surfaces,
                                  uint64_t memory, const std::filesystem::path& target);

}  // namespace surfcast::isosurface
