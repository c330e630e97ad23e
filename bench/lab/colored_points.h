#pragma once

#include "lab/scan_points.h"

namespace surfcast::lab {

/// Colours for a scan without any: grey by intensity, or the map of elevations where there is no intensity either,
/// under a light from above. The light is part of the colours, so that methods without light show it, too.
std::vector<glm::u8vec3> colors_for(const LabPoints& points);

}  // namespace surfcast::lab
