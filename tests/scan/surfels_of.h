#pragma once

#include <vector>

#include "scan/stated_radii.h"
#include "scan/surfel_report.h"
#include "scan/whole_scan.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::testing {

/// Surfels of scans, made as one part; everything but the weights is there.
surfel::SurfelCloud surfels_of(std::vector<WholeScan> scans, scan::SurfelReport& report,
                               scan::RadiusPolicy radii = scan::RadiusPolicy::kAuto);

}  // namespace surfcast::testing
