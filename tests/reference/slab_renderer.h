#pragma once

#include <cstdint>
#include <optional>

#include "geometry/camera.h"
#include "reference/light_picture.h"
#include "reference/transfer_function.h"
#include "reference/volume_grid.h"
#include "reference/volume_ray_caster.h"

namespace surfcast::reference {

/// How grids are drawn. The defaults are the method; the rest is for studies.
struct SlabParameters {
  double sigma = 0.6;      ///< standard deviation of kernels, grid spacings
  double cutoff = 9;       ///< largest r2 of a fragment
  int corrections = 2;     ///< of the samples
  double prefilter = 0.3;  ///< standard deviation under which footprints are drawn, pixels
  double thickness = 1;    ///< of slabs, in spacings of the samples along the view
  int steps = 8;           ///< of integration between two slab centres; 0: one at the front centre's scalar
  double clear = 1e-3;     ///< transmittance at which a ray ends
  bool by_centre = false;  ///< a kernel has the distance of its centre in every pixel, not that on the pixel's ray
  bool affine = false;     ///< footprints by Zwicker's form instead of the exact one, for kernels in front of the eye
  double unit = 0;         ///< to whose multiples what is added to slabs is rounded, as integer sums do; 0: exact
  bool filter = true;      ///< the finished picture with the pixel prefilter
  bool anchored = true;    ///< a slab through the volume's centre, as long as the eye is outside
  bool normalized = true;  ///< sums divided by those of the kernels' weights; clear where these are below one half
  bool leave_out = true;   ///< kernels that cannot show
  bool shaded = false;
};

/// What was drawn, and what it cost.
struct SlabDrawing {
  LightPicture picture;
  uint64_t kernels = 0;
  uint64_t fragments = 0;
  double largest_sum = 0;  ///< of |t (c - f0)| / D over a slab and pixel, before it is divided by the weights
};

/// Draws a grid as Gaussian kernels, summed into spherical slabs about the eye and classified afterwards. `outside` is
/// f0, which the sums are relative to. Normalised sums do not depend on it.
SlabDrawing draw_slabs(const VolumeGrid& samples, double outside, const TransferFunction& transfer,
                       const geometry::CameraFrame& frame, const SlabParameters& parameters = {},
                       const SurfaceLayers& layers = {}, const std::optional<ClipBox>& clip = {});

}  // namespace surfcast::reference
