#pragma once

#include <vector>

#include "estimation/stated_radii.h"
#include "estimation/surfel_report.h"
#include "scan/whole_scan.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::testing {

/// Surfels of scans, made as one part; everything but the weights is there.
surfel::SurfelCloud surfels_of(std::vector<WholeScan> scans, estimation::SurfelReport& report,
                               estimation::RadiusPolicy radii = estimation::RadiusPolicy::kAuto);

}  // namespace surfcast::testing
