#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "isosurface/iso_surface.h"
#include "isosurface/surface_rows.h"
#include "scan/scan_stream.h"

namespace surfcast::isosurface {

/// The surfaces found in an input.
struct InputSurfaces {
  std::string input;  ///< file name without its folders
  std::vector<SurfaceReport> surfaces;
};

/// Opens the inputs of a build: grids as points of their surfaces, everything else as scans.
class SurfaceInputs {
 public:
  /// Points wait beside `target`.
  SurfaceInputs(std::vector<IsoSurface> surfaces, std::filesystem::path target)
      : surfaces_(std::move(surfaces)), target_(std::move(target)) {}

  /// See builder::OpenInput.
  Result<scan::ScanStream> open(const std::filesystem::path& input, const scan::DecodingLimit& limit,
                                std::optional<uint64_t> sample);

  /// Of the grids opened so far.
  [[nodiscard]] const std::vector<InputSurfaces>& found() const { return found_; }

 private:
  std::vector<IsoSurface> surfaces_;
  std::filesystem::path target_;
  std::vector<InputSurfaces> found_;
};

}  // namespace surfcast::isosurface
