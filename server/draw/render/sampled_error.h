#pragma once

#include <vector>

#include "picture/picture.h"
#include "render/region.h"

namespace surfcast::render {

/// The difference of two pictures.
struct SquaredError {
  double squares = 0;  ///< over the pixels, the mean of the three colours' squared differences; levels of 8 bits
  double pixels = 0;   ///< covered in either picture
};

/// Compares a region of two 8 bit pictures of the same size, in which it lies.
SquaredError compare_pixels(const picture::Image& a, const picture::Image& b, const Region& region);

/// PSNR of a mean square of differences of 8 bit levels, dB; at most kSamePicture.
double psnr_of(double mean_square);

/// A part of a picture in which an error is measured.
struct SampledWindow {
  Region region;
  double weight = 0;  ///< factor of the squares in it for an estimate of all squares
};

/// Windows in which the error of a picture is estimated, and what is known about the rest of it.
struct ErrorSample {
  std::vector<SampledWindow> windows;
  double covered = 0;  ///< pixels of the whole picture
};

/// Chooses about `most` windows of `side` x `side` pixels of a picture of `width` x `height`, where its error is likely
/// to be: where two small, coarse pictures of the same camera differ, `fine` and `coarse`, of the same size. The
/// estimate is unbiased: the chance of a window is proportional to the square root of its difference times its covered
/// pixels, and its weight is the inverse. Always the same windows for the same pictures. Pictures of no more windows
/// are one.
ErrorSample choose_windows(const picture::Image& fine, const picture::Image& coarse, int width, int height, int side,
                           int most);

}  // namespace surfcast::render
