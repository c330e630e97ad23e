#pragma once

#include <glm/vec2.hpp>

#include "picture/picture.h"

namespace surfcast::render {

/// The request for the smaller picture that is enlarged for PictureRequest::render_scale: of at least one pixel, with
/// the same view angle. Lengths in pixels have the same size in the enlarged picture. The width is rounded up, so that
/// what is drawn reaches the sides. As in motion, silhouettes are not sampled, and what is behind the front surface of
/// a pixel is blended as one: at equal time more pixels are worth more.
picture::PictureRequest at_render_scale(const picture::PictureRequest& request);

/// An image at another size. Both show the same view: their heights span the same angle, and their middle columns meet.
/// Bicubic (Keys 1981, a = -1/2), in the codes of the pixels, clamped to their range.
picture::Image enlarge(const picture::Image& image, int width, int height);

/// The depth map of an enlarged picture. `drawn`: that of the picture of `size` pixels before; `map`: the map to fill,
/// of a picture of `enlarged` pixels. Each texel has the depth of the one at its middle.
void enlarge_depth(const picture::DepthMap& drawn, glm::ivec2 size, glm::ivec2 enlarged, picture::DepthMap& map);

}  // namespace surfcast::render
