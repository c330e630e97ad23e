#pragma once

#include <functional>
#include <glm/vec2.hpp>

#include "reference/linear_picture.h"

namespace surfcast::reference {

/// Linear colour at a position of the picture, in pixels from its top left corner.
using PixelSampler = std::function<glm::dvec3(const glm::dvec2& pixel)>;

/// The picture of `sample`, filtered with the pixel prefilter: a Gaussian with a variance of 1 px^2, cut at 4 px. Takes
/// 8 x 8 stratified samples per pixel, at positions up to 5 pixels outside of the picture.
LinearPicture filtered_picture(int width, int height, const PixelSampler& sample);

}  // namespace surfcast::reference
