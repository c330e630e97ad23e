#pragma once

#include <ostream>
#include <string>

#include "reference/reference_renderer.h"
#include "render/gl_fixture.h"

namespace surfcast::testing {

/// How far a picture is from the double precision reference of the same model, in linear light (1 is white).
struct Difference {
  double rms = 0;       ///< over all channels of all pixels
  double worst = 0;     ///< of any channel of any pixel
  double coverage = 0;  ///< largest difference of any pixel's coverage
  double peak = 0;      ///< largest coverage that the reference has: no difference, and no part of a bound
};
std::ostream& operator<<(std::ostream& out, const Difference& difference);

// What keeps a picture from its reference, largest first:
// - a fragment that lies at the cutoff or at the depth limit may fall on either side: with the coverage of a pixel at
//   a border where there is no other, kappa g (1 - g) exp(-c / 2) / a0(g) (docs/kernel.md), at most 0.06, at the gain
//   g = 0.7;
// - small splats have one ellipse, taken at their centre, and its factors in half precision;
// - colours are rounded to roots in 11, 11 and 10 bits: at most 1 / 1023 of linear light, at white;
// - single precision itself.

/// Rounded colours and single precision alone: where neither small splats nor cutoffs decide.
inline constexpr Difference kRounding{2e-4, 1e-3, 1e-5};
/// Also, within a magnified surface, the weight of a fragment at the cutoff: (1 - g) e^(-c / 2) of the peak.
inline constexpr Difference kMagnified{1e-3, 1.5e-2, 1.5e-2};
/// Also, at the border of a surface, a fragment at the cutoff, and what little half precision adds.
inline constexpr Difference kSplats{1.2e-3, 0.16, 0.07};

/// Every case draws a model twice, by the renderer and by the reference, and states how far apart they may be.
class NumericsGLTest : public RendererFixture {
 protected:
  /// Draws the picture both ways. Prints what it finds.
  static Difference difference(const std::string& what, const ModelPointer& model, picture::PictureRequest request);
  /// Compares a part of a picture in linear light, drawn already, with the reference.
  static Difference difference(const std::string& what, const picture::Image& image, const ModelPointer& model,
                               const picture::PictureRequest& request, const reference::Window& window);

  /// Fails where the difference is larger in any respect, or is no number.
  static void expect_within(const Difference& difference, const Difference& bound);
};

/// A colour of its own for every surfel, so that a wrong weight shows as a wrong colour.
void paint_motley(surfel::SurfelCloud& cloud);

}  // namespace surfcast::testing
