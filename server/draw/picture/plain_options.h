#pragma once

#include <glm/vec3.hpp>

namespace surfcast::picture {

// The choices of a picture. Their values have the order of those in surfcast.proto.

enum class Normalization { kPixel, kSurfel };
enum class Filter { kEwa, kNone };  ///< kNone leaves out the prefilter and uses the reconstruction kernel alone
enum class Shading { kAuto, kUnlit, kLit };

/// How Gaussian models are drawn: by the rules of their training programs, or exact in perspective, filtered, and in
/// the order of the depths in each pixel.
enum class SplatConvention { kTrained, kExact };

/// X-ray pictures of surfels: walls that are seen flat are thinner than their edges, in the order of depth, or surfels
/// are a medium that absorbs light.
enum class XRay { kOff, kSorted, kDensity };

/// The options of a picture that are one value: a choice, a number or a colour. The table of picture options
/// (protocol/picture_fields.cpp) says how each is written and what it may be.
struct PlainOptions {
  Normalization normalization = Normalization::kPixel;
  Filter filter = Filter::kEwa;
  Shading shading = Shading::kAuto;
  SplatConvention splat_convention = SplatConvention::kTrained;
  double spacing = 0;  ///< projected spacing at which refinement stops, pixels; 0: the finest level
  /// PSNR, dB, of the 8 bit picture against the one of spacing 0, over the pixels that either covers: the spacing is
  /// chosen for it. 0: not stated. Only with kWait.
  double error = 0;
  double time_ms = 0;               ///< likewise: the time of drawing and encoding; the render scale is chosen with it
  double render_scale = 1;          ///< the picture is drawn at this share of its sides (render/enlarge.h)
  glm::u8vec3 background{0, 0, 0};  ///< sRGB
  /// From 0 to 1. A factor of the opacities of surfels, transfer functions, iso-surfaces, slices, Gaussians and
  /// ellipsoids.
  double opacity = 1;
  double ghost = 0;  ///< factor of the opacities of the surfels that `clip` hides, from 0 to 1
  XRay xray = XRay::kOff;
};

/// Calls `use` with all members. A structured binding does not compile any more once there is another member.
template <typename Options, typename Use>
void with_members(Options& options, Use&& use) {
  auto& [normalization, filter, shading, splat_convention, spacing, error, time_ms, render_scale, background, opacity,
         ghost, xray] = options;
  use(normalization, filter, shading, splat_convention, spacing, error, time_ms, render_scale, background, opacity,
      ghost, xray);
}

}  // namespace surfcast::picture
