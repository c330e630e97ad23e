#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "base/result.h"
#include "colorize/geo_photo.h"
#include "colorize/paint_scan.h"
#include "scan/scan_stream.h"

namespace surfcast::colorize {

/// A scan with the colours of a picture from above: of its highest surface alone, because what is below it is not in
/// the picture. A point is hidden if another one, within one to two spacings, is more than three spacings higher. Other
/// points keep their colours, or are grey. The vertical axis is z. Colours are the mean over a spacing in linear light.
/// Fails if no point lies in the picture. `photo` must outlive the stream. Adds to `report`.
Result<scan::ScanStream> paint_from_above(scan::ScanStream scan, const std::filesystem::path& path,
                                          const GeoPhoto& photo, const scan::DecodingLimit& limit,
                                          std::optional<uint64_t> sample, PaintReport& report);

}  // namespace surfcast::colorize
