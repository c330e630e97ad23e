#pragma once

#include "scan/make_surfels.h"
#include "scan/scan_points.h"
#include "surfel/surfel_cloud.h"

namespace surfcast {

/// Drops points with coordinates that are not finite and, in a scan with normals, points whose normal is zero or not
/// finite; makes the remaining normals unit. A scan whose normals are all zero has none. Counts in `report` what was
/// dropped.
void drop_unusable_points(ScanPoints& points, SurfelReport& report);

/// Drops surfels that equal an earlier one in position and every attribute, to the bit. Surfels that share a position
/// but differ in an attribute all stay: the finest level keeps every source point with all its attributes.
void drop_duplicates(SurfelCloud& cloud, SurfelReport& report);

}  // namespace surfcast
