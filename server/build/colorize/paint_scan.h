#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>

#include "base/result.h"
#include "scan/scan_stream.h"

namespace surfcast::colorize {

/// What became of the points of scans.
struct PaintReport {
  uint64_t painted = 0;
  uint64_t hidden = 0;   ///< behind or below something else
  uint64_t outside = 0;  ///< beside the picture, or where it has no data
};

enum class Paint : uint8_t { kPainted, kHidden, kOutside };

/// Changes the sRGB colour of a point that a picture shows. Called from any thread.
using Painter = std::function<Paint(const glm::dvec3& position, glm::u8vec3& color)>;

/// A scan whose points `painter` has coloured. Other points keep their colours, or are grey. Fails if there is no point
/// that is coloured. Adds to `report`. What `painter` refers to must outlive the stream.
Result<scan::ScanStream> paint_scan(scan::ScanStream scan, const std::filesystem::path& path, Painter painter,
                                    std::optional<uint64_t> sample, PaintReport& report);

}  // namespace surfcast::colorize
