#pragma once

#include <span>
#include <string>
#include <vector>

#include "scan/scan_points.h"
#include "scan/scan_schema.h"

namespace surfcast::scan {

/// What a cloud of all the scans has: every attribute of any of them. Scalars of one name but several types get the
/// smallest type that holds all their values; colours of 8 and 16 bit together become 16 bit. The cloud is z-up unless
/// no scan is. Name, grid and sensor stay those of each scan.
ScanSchema merge_schemas(std::span<const ScanSchema> scans);

/// One line for every colour and scalar that `conform` fills in for a scan that lacks it.
std::vector<std::string> describe_fillings(std::span<const ScanSchema> scans, const ScanSchema& cloud);

/// Gives points of one scan all the attributes of the cloud: where theirs lack one, colour is filled in with mid-grey,
/// scalars with 0, and normals and radii with NaN, to be estimated.
ScanPoints conform(ScanPoints points, const ScanSchema& cloud);

}  // namespace surfcast::scan
