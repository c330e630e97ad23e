#pragma once

#include <string>
#include <vector>

#include "picture/picture.h"
#include "reference/linear_picture.h"
#include "reference/ray_surface.h"
#include "reference/texture.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::reference {

/// A sampled surface, a view of it, and the analytic surface, from which the ideal picture can be computed.
struct Scene {
  std::string name;
  surfel::SurfelCloud cloud;
  picture::PictureRequest request;  ///< 512 x 512, per pixel normalisation, EWA
  RaySurface surface;
  Texture texture;  ///< empty if the cloud has no colours; the surface is then lit
};

/// Names of all scenes, for make_scene.
std::vector<std::string> scene_names();
Scene make_scene(const std::string& name);

/// The analytic surface over the background, ray cast and filtered with the pixel prefilter in linear light.
LinearPicture ideal_picture(const Scene& scene);
/// Coverage of every pixel by the analytic surface, with the same filter.
std::vector<double> ideal_coverage(const Scene& scene);

}  // namespace surfcast::reference
