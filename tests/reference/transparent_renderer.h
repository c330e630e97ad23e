#pragma once

#include <vector>

#include "picture/picture.h"
#include "reference/linear_picture.h"
#include "reference/resampling_filter.h"
#include "shared/transparency.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::reference {

/// The constants of shaders/shared/transparency.h as variables, so that a study can change them.
struct TransparencyParameters {
  double depth = SURFCAST_SURFACE_DEPTH;
  double least_cosine = SURFCAST_SURFACE_LEAST_COSINE;
  double whole = SURFCAST_SURFACE_WHOLE;
  double repair = SURFCAST_SURFACE_REPAIR;
  double more = SURFCAST_SURFACE_MORE;
  double sum = SURFCAST_SURFACE_SUM;
  int in_order = SURFCAST_SURFACES_IN_ORDER;
  int finds = SURFCAST_SURFACE_FINDS;
};

/// A picture of surfaces that are seen through, blended with the background.
struct TransparentPicture {
  LinearPicture picture;
  std::vector<double> opacity;  ///< of all surfaces of a pixel
};

/// Draws the cloud in double precision, its surfels with these opacities (0 to 1): the surfaces of a pixel are told
/// apart by the depths of their discs, and composited from front to back (docs/transparency.md). The request
/// states its camera. Of its other members, the size, the background, shading and normalization have an effect; the
/// weights of the cloud count with Normalization::kSurfel only.
TransparentPicture render_transparent(const surfel::SurfelCloud& cloud, const std::vector<double>& opacities,
                                      const picture::PictureRequest& request, const KernelParameters& kernel = {},
                                      const TransparencyParameters& parameters = {});

/// As render_transparent, but as a medium: light is absorbed by the opacities of all fragments, whatever their order.
/// The weights of the cloud always count.
TransparentPicture render_density(const surfel::SurfelCloud& cloud, const std::vector<double>& opacities,
                                  const picture::PictureRequest& request, const KernelParameters& kernel = {},
                                  const TransparencyParameters& parameters = {});

}  // namespace surfcast::reference
