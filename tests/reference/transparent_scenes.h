#pragma once

#include <functional>
#include <string>
#include <vector>

#include "picture/picture.h"
#include "reference/linear_picture.h"
#include "reference/ray_surface.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::reference {

/// What a ray meets: a surface that is seen through.
struct Layer {
  double depth = 0;     ///< along the ray, in units of its direction
  glm::dvec3 color{0};  ///< linear light
  double opacity = 1;
  int sheet = 0;  ///< of the scene
};

/// Sheets that are seen through: their samples, a view, and the layers of every ray.
struct TransparentScene {
  std::string name;
  surfel::SurfelCloud cloud;  ///< with weights
  std::vector<double> opacities;
  picture::PictureRequest request;  ///< 256 x 256
  std::function<std::vector<Layer>(const glm::dvec3& origin, const glm::dvec3& direction)> layers;
};

/// Names of all scenes.
std::vector<std::string> transparent_scene_names();
TransparentScene make_transparent_scene(const std::string& name);

/// The analytic layers, composited for each of 8 x 8 rays of a pixel, filtered with the pixel prefilter.
LinearPicture ideal_picture(const TransparentScene& scene);

/// Pixels within the filter of which all rays meet the same sheets: the inside of the picture.
std::vector<bool> inside(const TransparentScene& scene);

/// Peak signal to noise ratio of 8 bit sRGB over the pixels of a mask, dB.
double masked_psnr(const SrgbPicture& a, const SrgbPicture& b, const std::vector<bool>& mask);

}  // namespace surfcast::reference
