#pragma once

#include <ostream>
#include <string>

#include "reference/reference_renderer.h"
#include "render/gl_fixture.h"

namespace surfcast::testing {

/// Difference of a picture from the double precision reference of the same model, in linear light (1 is white).
struct Difference {
  double rms = 0;       ///< over all channels of all pixels
  double worst = 0;     ///< largest difference of a channel of a pixel
  double coverage = 0;  ///< largest difference of the coverage of a pixel
  double peak = 0;      ///< largest coverage in the reference; for information only, not part of a bound
};
std::ostream& operator<<(std::ostream& out, const Difference& difference);

// Causes of differences between a picture and its reference, largest first:
// - A fragment at the cutoff or at the depth limit may be accepted or rejected. At a border, where it may be the only
//   fragment of a pixel, this changes the coverage by kappa g (1 - g) exp(-c / 2) / a0(g) (docs/kernel.md): at most
//   0.06, at a gain of g = 0.7.
// - Small splats use one ellipse, computed at their centre, with factors in half precision.
// - Colours are rounded to square roots in 11, 11 and 10 bits: at most 1 / 1023 of linear light, at white.
// - Single precision itself.

/// Bound for rounded colours and single precision only, without small splats and fragments at cutoffs.
inline constexpr Difference kRounding{2e-4, 1e-3, 1e-5};
/// Also includes, within a magnified surface, the weight of a fragment at the cutoff: (1 - g) e^(-c / 2) of the peak.
inline constexpr Difference kMagnified{1e-3, 1.5e-2, 1.5e-2};
/// Also includes a fragment at the cutoff at the border of a surface, and the small error of half precision.
inline constexpr Difference kSplats{1.2e-3, 0.16, 0.07};

/// Every case draws a model with the renderer and with the reference, and states a bound of their difference.
class NumericsGLTest : public RendererFixture {
 protected:
  /// Draws the picture with both and prints their difference.
  static Difference difference(const std::string& what, const ModelPointer& model, picture::PictureRequest request);
  /// Compares a part of an existing picture in linear light with the reference.
  static Difference difference(const std::string& what, const picture::Image& image, const ModelPointer& model,
                               const picture::PictureRequest& request, const reference::Window& window);

  /// Fails if a component of the difference is above its bound or NaN.
  static void expect_within(const Difference& difference, const Difference& bound);
};

/// Gives every surfel a different colour, so that a wrong weight becomes visible as a wrong colour.
void paint_motley(surfel::SurfelCloud& cloud);

}  // namespace surfcast::testing
