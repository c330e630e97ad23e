#pragma once

#include <string>
#include <vector>

#include "picture/picture.h"
#include "reference/linear_picture.h"
#include "reference/ray_surface.h"
#include "reference/texture.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::reference {

/// A sampled surface, a view of it, and what it samples, so that the ideal picture can be computed.
struct Scene {
  std::string name;
  surfel::SurfelCloud cloud;
  picture::PictureRequest request;  ///< 512 x 512, per pixel normalisation, EWA
  RaySurface surface;
  Texture texture;  ///< empty where the cloud has no colours: the surface is lit
};

/// Names of every scene, for make_scene.
std::vector<std::string> scene_names();
Scene make_scene(const std::string& name);

/// The analytic surface, ray cast and filtered with the pixel prefilter in linear light, background included.
LinearPicture ideal_picture(const Scene& scene);
/// Share of every pixel, under the same filter, that the analytic surface covers.
std::vector<double> ideal_coverage(const Scene& scene);

}  // namespace surfcast::reference
