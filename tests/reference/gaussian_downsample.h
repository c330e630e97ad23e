#pragma once

#include <functional>
#include <glm/vec2.hpp>

#include "reference/linear_picture.h"

namespace surfcast::reference {

/// Linear colour seen at a position of the picture in pixels, (0, 0) its top left corner.
using PixelSampler = std::function<glm::dvec3(const glm::dvec2& pixel)>;

/// The picture of `sample` under the pixel prefilter, a Gaussian of variance 1 px^2 cut at 4 px: 8 x 8 stratified
/// samples per pixel. Positions up to 5 pixels outside of the picture are asked for.
LinearPicture filtered_picture(int width, int height, const PixelSampler& sample);

}  // namespace surfcast::reference
