#pragma once

#include <span>

#include "reference/linear_picture.h"

namespace surfcast::lab {

using reference::SrgbPicture;

/// Error of a picture against the ideal one.
struct PictureErrors {
  double psnr = 0;        ///< dB, over all channels of all pixels; infinite for equal pictures
  double ssim = 0;        ///< mean structural similarity of luma, 1 for equal pictures
  double worst_tile = 0;  ///< dB, the lowest PSNR of the tiles of 32 x 32 pixels
};
PictureErrors picture_errors(const SrgbPicture& drawn, const SrgbPicture& ideal);

/// Mean structural similarity (Wang 2004, equation 13) of luma under a Gaussian window with a standard deviation of 1.5
/// pixels, over the windows of 11 x 11 pixels inside the picture. Pictures must not be smaller than a window.
double ssim(const SrgbPicture& a, const SrgbPicture& b);

/// Lowest PSNR of the tiles of `side` x `side` pixels, dB. Tiles at the right and lower border may be smaller.
double worst_tile(const SrgbPicture& a, const SrgbPicture& b, int side);

/// Temporal error of a camera path, in levels of 255: the root mean square of the change of the error from frame to
/// frame. A constant error does not count as flicker, nor do changes in the ideal pictures.
double flicker(std::span<const SrgbPicture> drawn, std::span<const SrgbPicture> ideal);

}  // namespace surfcast::lab
