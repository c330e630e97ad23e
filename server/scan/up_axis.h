#pragma once

#include <span>

#include "geometry/box.h"
#include "scan/scan_schema.h"

namespace surfcast::scan {

/// Whether points of a format that does not say which way is up, and is used by both graphics (y-up) and surveying
/// (z-up), come from a survey: they carry an attribute that only LiDAR has (classification, returns, GPS time), lie
/// farther from the origin than a model would, or spread at least twice as far along x and along y as along z.
bool looks_like_survey(std::span<const ScalarField> scalars, const geometry::Box& bounds);

}  // namespace surfcast::scan
