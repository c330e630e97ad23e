#pragma once

#include <span>

#include "reference/linear_picture.h"

namespace surfcast::lab {

using reference::SrgbPicture;

/// How far a picture is from the ideal one.
struct PictureErrors {
  double psnr = 0;        ///< dB, over all channels of all pixels; infinite for equal pictures
  double ssim = 0;        ///< mean structural similarity of luma, 1 for equal pictures
  double worst_tile = 0;  ///< dB, PSNR of the tile of 32 x 32 pixels that is furthest off
};
PictureErrors picture_errors(const SrgbPicture& drawn, const SrgbPicture& ideal);

/// Mean structural similarity (Wang 2004, equation 13) of luma under a Gaussian window of deviation 1.5 pixels, over
/// the windows of 11 x 11 pixels that lie within the picture. Pictures are at least that large.
double ssim(const SrgbPicture& a, const SrgbPicture& b);

/// Least PSNR of all tiles of `side` x `side` pixels, those at the right and lower border cut off, dB.
double worst_tile(const SrgbPicture& a, const SrgbPicture& b, int side);

/// Temporal error of a camera path in levels of 255: the root mean square of what the error changes by from frame to
/// frame. An error that stands still is no flicker, and nor is change that the ideal pictures show.
double flicker(std::span<const SrgbPicture> drawn, std::span<const SrgbPicture> ideal);

}  // namespace surfcast::lab
