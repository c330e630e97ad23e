#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "scan/scan_points.h"
#include "scan/surfel_report.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::scan {

/// Drops points with coordinates that are not finite and, in a scan with normals, points whose normal is zero or not
/// finite; makes the remaining normals unit. Counts in `report` what was dropped.
void drop_unusable_points(ScanPoints& points, SurfelReport& report);

/// For each surfel whether an earlier one equals it in position and every attribute, to the bit. Surfels that share a
/// position but differ in an attribute are no duplicates: the finest level keeps every source point with all its
/// attributes.
std::vector<bool> find_duplicates(const surfel::SurfelCloud& cloud);

/// Keeps some of the surfels, with all their attributes.
void keep_surfels(surfel::SurfelCloud& cloud, const std::vector<bool>& keep);

}  // namespace surfcast::scan
