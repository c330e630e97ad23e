#pragma once

#include <string>

#include "lab/results.h"

namespace surfcast::lab {

/// An SVG with one plot for each scene: PSNR against milliseconds (logarithmic), with the Pareto frontier as a line.
std::string svg_of(const LabResults& results);

}  // namespace surfcast::lab
