#include "numerics/sample_pictures.h"

#include <cmath>

#include "base/hash.h"
#include "support/clouds.h"

namespace surfcast::testing {
namespace {

picture::PictureRequest view_from(const glm::dvec3& eye, const glm::dvec3& target, double angle) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{eye, target, {0.1, 0.2, 0.97}, angle};
  request.width = 96;
  request.height = 72;
  request.background = {30, 40, 60};
  return request;
}

/// A sphere coloured by longitude and latitude, so that pictures compress well and errors are visible.
surfel::SurfelCloud globe(size_t surfels) {
  surfel::SurfelCloud cloud = fibonacci_sphere(surfels, 1, {0, 0, 0}, {0, 0, 0});
  for (size_t i = 0; i < cloud.size(); ++i) {
    const glm::dvec3& p = cloud.positions[i];
    const bool dark = (p.z * 6 - std::floor(p.z * 6) < 0.5) != (p.x * p.y > 0);
    cloud.colors->values[i] = dark ? glm::u16vec3(40, 90, 160) : glm::u16vec3(240, 200, 120);
  }
  return cloud;
}

surfel::SurfelCloud without_colors(surfel::SurfelCloud cloud) {
  cloud.colors.reset();
  return cloud;
}

surfel::SurfelCloud two_sided(surfel::SurfelCloud cloud) {
  cloud.oriented = false;
  return cloud;
}

surfel::SurfelCloud checkered_square(int side, double extent, const glm::dvec3& centre) {
  surfel::SurfelCloud cloud = square(side, extent, centre, {0, 0, 1}, {255, 255, 255});
  for (int i = 0; i < side * side; ++i) {
    const bool dark = (i % side * 8 / side + i / side * 8 / side) % 2 == 0;
    if (dark) cloud.colors->values[static_cast<size_t>(i)] = glm::u16vec3(60, 20, 20);
  }
  return cloud;
}

surfel::SurfelCloud square_before_globe() {
  surfel::SurfelCloud cloud = globe(8000);
  append(cloud, checkered_square(40, 0.8, {1.2, 0, 0.4}));
  return cloud;
}

}  // namespace

std::vector<SamplePicture> sample_pictures() {
  const picture::PictureRequest outside = view_from({3, -2, 1.5}, {0, 0, 0}, 35);
  picture::PictureRequest per_surfel = outside;
  per_surfel.normalization = picture::Normalization::kSurfel;
  picture::PictureRequest unfiltered = outside;
  unfiltered.filter = picture::Filter::kNone;
  picture::PictureRequest lit = outside;
  lit.shading = picture::Shading::kLit;
  picture::PictureRequest coarse = outside;
  coarse.spacing = 3;
  picture::PictureRequest eye_dome = outside;
  eye_dome.eye_dome.strength = 1;
  eye_dome.silhouettes = true;
  picture::PictureRequest silhouettes = outside;
  silhouettes.silhouettes = true;
  return {{"globe", globe(20000), outside},
          {"globe_per_surfel", globe(20000), per_surfel},
          {"globe_unfiltered", globe(3000), unfiltered},
          {"globe_lit", globe(8000), lit},
          {"globe_grey", without_colors(globe(8000)), outside},
          {"globe_coarse", globe(60000), coarse},
          {"globe_far", globe(60000), view_from({90, -60, 45}, {0, 0, 0}, 35)},
          {"globe_inside", two_sided(globe(1500)), view_from({0.9, 0, 0}, {1.1, 1, 0.2}, 100)},
          {"square_close", checkered_square(40, 1, {0, 0, 0}), view_from({0.1, -0.3, 0.05}, {0, 0.1, 0}, 50)},
          {"square_grazing", checkered_square(100, 1, {0, 0, 0}), view_from({0.1, -1.2, 0.04}, {0, 0, 0}, 40)},
          {"square_before_globe", square_before_globe(), outside},
          {"square_silhouettes", square_before_globe(), silhouettes},
          {"globe_eye_dome", square_before_globe(), eye_dome}};
}

uint64_t hash_of(const picture::Image& image) {
  return surfcast::hash_of(image.pixels);
}

}  // namespace surfcast::testing
