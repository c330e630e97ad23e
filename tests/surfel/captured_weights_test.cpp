// Weights found from the neighbours against weights captured from rendered views, as Ren 2002, section 7.1, finds them.

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "reference/reference_renderer.h"
#include "reference/sampling.h"
#include "shared/kernel.h"
#include "surfel/even_sampling.h"
#include "surfel/normalization_weights.h"

namespace surfcast::surfel {
namespace {

using reference::KernelParameters;

constexpr int kViews = 40;
constexpr int kResolution = 512;  // pixels; a spacing of samples is some 25 of them

/// The renderer's sums of kernels: with a coverage that leaves every sum as it is, and one cutoff, of which nothing is
/// taken off the kernel.
KernelParameters plain_sums() {
  KernelParameters kernel;
  kernel.cutoff_minified = kernel.cutoff_magnified;
  kernel.coverage_minified = kernel.coverage_magnified = 1;
  return kernel;
}

picture::PictureRequest view_from(const glm::dvec3& direction) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{4.0 * direction, {0, 0, 0}, {0, 0, 1}, 30};
  request.width = request.height = kResolution;
  request.filter = picture::Filter::kNone;
  request.normalization = picture::Normalization::kSurfel;  // of weights 1: nothing is scaled
  return request;
}

/// For every surfel, 1 / the sum that each view shows at its centre, where it faces the view.
std::vector<std::vector<double>> capture(SurfelCloud cloud) {
  cloud.weights.assign(cloud.size(), 1);
  std::vector<std::vector<double>> captured(cloud.size());
  for (const reference::SurfacePoint& from : reference::jittered_sphere(kViews, 0, 1)) {
    const picture::PictureRequest request = view_from(from.position);
    const reference::ReferencePicture view = reference::render(cloud, request, plain_sums());
    const geometry::CameraFrame frame = *geometry::make_camera_frame(*request.camera, kResolution, kResolution);
    for (size_t i = 0; i < cloud.size(); ++i) {
      const glm::dvec3 o = frame.to_camera(cloud.positions[i]);
      const glm::dvec3 n = frame.rotate(glm::dvec3(cloud.normals[i]));
      if (-glm::dot(n, glm::normalize(o)) < 0.6) continue;
      const glm::dvec2 pixel = glm::floor(frame.project(o));
      const size_t place = view.picture.index(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
      captured[i].push_back(per_surfel_scale(SURFCAST_KERNEL_SIGMA) / view.weights[place]);
    }
  }
  return captured;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

TEST(CapturedWeights, AgreeWithWeightsFromTheNeighbours) {
  const SurfelCloud cloud = reference::surfels_at(reference::jittered_sphere(2000, 0.3, 5));
  const std::vector<float> weights = normalization_weights(cloud);
  const std::vector<std::vector<double>> captured = capture(cloud);
  size_t seen = 0;
  size_t close = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (captured[i].size() < 3) continue;
    ++seen;
    close += std::abs(median(captured[i]) / weights[i] - 1) < 0.05 ? 1 : 0;
  }
  EXPECT_GT(seen, cloud.size() * 9 / 10);
  EXPECT_GT(close, seen * 95 / 100);
}

}  // namespace
}  // namespace surfcast::surfel
