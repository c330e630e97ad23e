#pragma once

#include <optional>
#include <vector>

#include "picture/picture.h"
#include "reference/linear_picture.h"
#include "reference/resampling_filter.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::reference {

/// A picture, and what was accumulated for each of its pixels.
struct ReferencePicture {
  LinearPicture picture;         ///< blended with the background
  std::vector<double> weights;   ///< A, the accumulated weights (times the multipliers of coverage)
  std::vector<double> coverage;  ///< min(1, A)
  uint64_t fragments = 0;        ///< fragments within the cutoff, hidden ones included: what drawing costs
};

/// Pixels of a picture, counted from its top left corner.
struct Window {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// Draws the finest level of the cloud in double precision, deterministically. The request states its camera; pixels
/// are never quantised. Weights of the cloud are used for Normalization::kSurfel alone. With a window, only the part
/// of the picture that lies in it.
ReferencePicture render(const surfel::SurfelCloud& cloud, const picture::PictureRequest& request,
                        const KernelParameters& kernel = {}, const std::optional<Window>& window = {});

/// The accumulated weight at which a pixel counts as fully covered, for fragments of the given gain.
double saturation(double gain, const KernelParameters& kernel);

}  // namespace surfcast::reference
