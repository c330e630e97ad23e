#pragma once

#include <span>
#include <string>
#include <vector>

#include "scan/scan_points.h"
#include "scan/scan_schema.h"

namespace surfcast::scan {

/// The schema of a cloud of several scans: the union of their attributes. Scalars of one name but several types get the
/// smallest type that holds all their values. Colours of 8 and 16 bits together become 16 bits. The cloud is z-up
/// unless no scan is. Name, grid and sensor are left to each scan.
ScanSchema merge_schemas(std::span<const ScanSchema> scans);

/// One line for each colour or scalar that `conform` fills in for a scan without it.
std::vector<std::string> describe_fillings(std::span<const ScanSchema> scans, const ScanSchema& cloud);

/// Extends points of one scan to all attributes of the cloud. Missing colours become mid-grey, missing scalars 0.
/// Missing normals and radii become NaN and are estimated later.
ScanPoints conform(ScanPoints points, const ScanSchema& cloud);

}  // namespace surfcast::scan
