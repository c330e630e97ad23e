#pragma once

#include "geometry/camera.h"
#include "reference/gaussian_model.h"
#include "reference/light_picture.h"

namespace surfcast::reference {

/// How a Gaussian model is trained, and drawn so.
enum class GaussianConvention {
  kTrained,      ///< 3D Gaussian Splatting (Kerbl 2023), as in the authors' rasterizer
  kAntialiased,  ///< the same, with the opacity that the added variance takes (Mip-Splatting, gsplat)
  kFlat,         ///< 2D Gaussian Splatting (Huang 2024)
};

/// Constants of the authors' rasterizers, which are of single precision.
struct TrainedRules {
  double near = 0.2;         ///< depth of the nearest centre, camera z
  double clamp = 1.3;        ///< tangents at which the projection is linearised, in half views
  double dilation = 0.3;     ///< added variance, square pixels
  double most = 0.99F;       ///< opacity of a fragment; two of these leave less than `clear` in single precision only
  double least = 1.0 / 255;  ///< opacity of a fragment
  double clear = 1e-4F;      ///< no fragment is drawn that would bring the transmittance below
  bool tiles = true;         ///< a splat is drawn in the tiles of 16 x 16 pixels that its three deviations touch
};

/// Premultiplied sRGB codes, in the order of the centres' depths, one order for a picture.
LightPicture draw_as_trained(const GaussianModel& model, const geometry::CameraFrame& frame,
                             GaussianConvention convention, const TrainedRules& rules = {});

/// How a picture that is exact in perspective is drawn.
struct ExactRules {
  double prefilter = 1;        ///< standard deviation, pixels
  double cutoff = 25;          ///< largest r2 of a fragment
  bool order_by_pixel = true;  ///< by the depths on the pixel's ray; else by those of the centres
};

/// Premultiplied sRGB codes: exact footprints with the opacity that the prefilter leaves of them, what lies behind the
/// eye left out.
LightPicture draw_exactly(const GaussianModel& model, const geometry::CameraFrame& frame, const ExactRules& rules = {});

/// The mean of exact rays without a prefilter, `samples` x `samples` a pixel, under the pixel prefilter.
LightPicture ideal_picture(const GaussianModel& model, const geometry::CameraFrame& frame, int samples);

}  // namespace surfcast::reference
