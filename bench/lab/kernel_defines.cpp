#include "lab/kernel_defines.h"

#include <cmath>
#include <cstdio>

#include "shared/kernel.h"

namespace surfcast::lab {

std::string kernel_defines(double sigma) {
  // The renderer scales all weights for the sigma of kernel.h. The sums at which a pixel is covered make up for that.
  const double scale = std::pow(sigma / SURFCAST_KERNEL_SIGMA, 2);
  char text[400];
  std::snprintf(text, sizeof text,
                "#define SURFCAST_OTHER_KERNEL\n"
                "#define SURFCAST_KERNEL_SIGMA %.9f\n"
                "#define SURFCAST_KERNEL_CUTOFF_MINIFIED %.9f\n"
                "#define SURFCAST_KERNEL_CUTOFF %.9f\n"
                "#define SURFCAST_COVERAGE_MINIFIED %.9f\n"
                "#define SURFCAST_COVERAGE_MAGNIFIED %.9f\n",
                sigma, SURFCAST_KERNEL_CUTOFF_MINIFIED, SURFCAST_KERNEL_CUTOFF, scale * SURFCAST_COVERAGE_MINIFIED,
                scale * SURFCAST_COVERAGE_MAGNIFIED);
  return text;
}

}  // namespace surfcast::lab
