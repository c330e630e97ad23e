#pragma once

#include <string>
#include <vector>

#include "scan/scan_points.h"
#include "surfel/surfel_cloud.h"

namespace surfcast {

/// Joins scans into one cloud, in order. An attribute that only some of the scans have is filled in for the others:
/// colour with mid-grey, scalars with 0, and normals and radii with NaN, to be estimated. `notes` gets one line for
/// every filling of a colour or scalar. Scalars of one name but several types get the smallest type that holds all
/// their values; colours of 8 and 16 bit together become 16 bit. The cloud is z-up unless no scan is.
SurfelCloud merge_scans(std::vector<ScanPoints> scans, std::vector<std::string>& notes);

}  // namespace surfcast
