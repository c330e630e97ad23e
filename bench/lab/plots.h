#pragma once

#include <string>

#include "lab/results.h"

namespace surfcast::lab {

/// One plot for each scene in an SVG: milliseconds across (logarithmic), PSNR upwards, the frontier as a line.
std::string svg_of(const LabResults& results);

}  // namespace surfcast::lab
