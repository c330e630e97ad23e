#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "estimation/surfel_report.h"
#include "scan/scan_points.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::estimation {

/// Drops points with coordinates that are not finite. In a scan with normals, also drops points whose normal is zero or
/// not finite, and normalises the others. Counts the dropped points in `report`.
void drop_unusable_points(scan::ScanPoints& points, SurfelReport& report);

/// For each surfel, whether an earlier surfel has the same position and the same attributes, to the bit. Surfels that
/// share a position but differ in an attribute are no duplicates, because the finest level keeps every source point
/// with all its attributes.
std::vector<bool> find_duplicates(const surfel::SurfelCloud& cloud);

/// Removes the surfels whose `keep` is false, with all their attributes.
void keep_surfels(surfel::SurfelCloud& cloud, const std::vector<bool>& keep);

}  // namespace surfcast::estimation
