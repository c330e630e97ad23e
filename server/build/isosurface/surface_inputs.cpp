#include "isosurface/surface_inputs.h"

#include <utility>

#include "builder/grid_input.h"
#include "grid/open_scan.h"

namespace surfcast::isosurface {

Result<scan::ScanStream> SurfaceInputs::open(const std::filesystem::path& input, const scan::DecodingLimit& limit,
                                             std::optional<uint64_t> sample) {
  if (!builder::is_grid(input)) return grid::open_scan(input, limit, sample);
  Result<SurfaceRows> surfaces = find_surfaces(input, surfaces_, limit.max_bytes, target_);
  if (!surfaces) return fail(surfaces);
  found_.push_back({input.filename().string(), std::move(surfaces->reports)});
  return scan::ScanStream::of_rows(std::move(surfaces->rows), input, sample);
}

}  // namespace surfcast::isosurface
