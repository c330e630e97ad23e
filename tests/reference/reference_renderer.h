#pragma once

#include <optional>
#include <vector>

#include "picture/picture.h"
#include "reference/linear_picture.h"
#include "reference/resampling_filter.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::reference {

/// A picture, and the accumulated values of its pixels.
struct ReferencePicture {
  LinearPicture picture;         ///< blended with the background
  std::vector<double> weights;   ///< A: the accumulated weights of the front layer, relative to full coverage
  std::vector<double> coverage;  ///< of all layers, in [0, 1]
  uint64_t fragments = 0;        ///< fragments within the cutoff, hidden ones included: the cost of drawing
};

/// A part of a picture, in pixels from its top left corner.
struct Window {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// Draws the cloud in double precision, deterministically and without quantisation. The request must state its camera.
/// The weights of the cloud are used for Normalization::kSurfel only. With a window, draws only this part of the
/// picture.
ReferencePicture render(const surfel::SurfelCloud& cloud, const picture::PictureRequest& request,
                        const KernelParameters& kernel = {}, const std::optional<Window>& window = {});

/// The accumulated weight at which a pixel counts as fully covered, for fragments of the given gain.
double saturation(double gain, const KernelParameters& kernel);

}  // namespace surfcast::reference
