#pragma once

#include <span>

#include "geometry/box.h"
#include "scan/scan_schema.h"

namespace surfcast::scan {

/// Whether points come from a survey (z-up) rather than from graphics (y-up), for formats that are used by both and do
/// not state the vertical axis. True if they have an attribute that only LiDAR has (classification, returns, GPS time),
/// lie farther from the origin than a model would, or extend at least twice as far along x and along y as along z.
bool looks_like_survey(std::span<const ScalarField> scalars, const geometry::Box& bounds);

}  // namespace surfcast::scan
