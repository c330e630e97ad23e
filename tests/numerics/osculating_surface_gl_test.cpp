// Depths, places and normals of surfels with curvature in the single precision of the device, beside double precision,
// for any shape and distance.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "numerics/shader_bench.h"
#include "surfel/curvature.h"

namespace surfcast::testing {
namespace {

constexpr int kCases = 4000;
constexpr double kQuantile = 0.999;
constexpr double kGrazing = 0.05;  // least cosine of a ray to the normal: silhouettes end before

/// A curvature, the distance of the eye, both in radii of the surfel, and the errors that are allowed.
struct Bend {
  const char* name;
  surfel::Curvature curvature;
  double distance;
  double depth;   ///< radii
  double normal;  ///< degrees
};

constexpr const char* kBody = R"(
  vec3 n = in_[1].xyz;
  vec3 u, v;
  tangent_frame(n, u, v);
  vec2 place;
  float depth = enter_surface(in_[0].xyz, n, u, v, in_[2].xyz, in_[3].xyz, place);
  out_[0] = vec4(depth, place, 0.0);
  out_[1] = vec4(normal_of_surface(n, u, v, in_[2].xyz, place), 0.0);
)";
constexpr std::array kFiles{"curved/surface.glsl"};

double quantile(std::vector<double> errors) {
  std::ranges::sort(errors);
  return errors[static_cast<size_t>(kQuantile * static_cast<double>(errors.size() - 1))];
}

class OsculatingSurfaces : public ::testing::TestWithParam<Bend> {
 protected:
  glm::dvec3 random_direction() {
    std::normal_distribution<double> part(0, 1);
    const double x = part(random_);
    const double y = part(random_);
    const double z = part(random_);
    return glm::normalize(glm::dvec3(x, y, z));
  }

  /// Adds a surfel and the ray to a place on it, unless the ray grazes it. All numbers are of single precision.
  void add(const Bend& bend) {
    std::uniform_real_distribution<double> unit(0, 1);
    const glm::vec3 ray(glm::dvec3(0.8 * (unit(random_) - 0.5), 0.8 * (unit(random_) - 0.5), 1));
    surfel::OsculatingSurface surface;
    surface.normal = random_direction();
    if (std::abs(surface.normal.z) < 1e-3) return;
    surface.frame = surfel::tangent_frame(surface.normal);
    surface.curvature = bend.curvature;
    const double turn = 2 * std::numbers::pi * unit(random_);
    const glm::dvec2 q = std::sqrt(unit(random_)) * glm::dvec2(std::cos(turn), std::sin(turn));
    const double sag = 0.5 * glm::dot(q, bend.curvature.times(q));
    const glm::dvec3 aside = q.x * surface.frame.u + q.y * surface.frame.v - sag * surface.normal;
    const glm::vec3 centre(bend.distance * glm::normalize(glm::dvec3(ray)) - aside);
    const glm::vec3 normal(surface.normal);
    surface.centre = centre;
    surface.normal = glm::normalize(glm::dvec3(normal));
    surface.frame = surfel::tangent_frame(surface.normal);
    const auto hit = surfel::meet(surface, ray, true);
    if (!hit || glm::length(hit->place) > 1.5) return;
    if (-glm::dot(hit->normal, glm::normalize(glm::dvec3(ray))) < kGrazing) return;
    hits_.push_back(*hit);
    const surfel::Curvature& k = bend.curvature;
    inputs_.insert(inputs_.end(),
                   {glm::vec4(centre, 0), glm::vec4(normal, 0), glm::vec4(k.uu, k.uv, k.vv, 0), glm::vec4(ray, 0)});
  }

  std::mt19937 random_{5};
  std::vector<surfel::SurfaceHit> hits_;
  std::vector<glm::vec4> inputs_;
};

TEST_P(OsculatingSurfaces, AgreeWithDoublePrecision) {
  const Bend& bend = GetParam();
  for (int i = 0; i < kCases; ++i) add(bend);
  ASSERT_GT(hits_.size(), size_t{kCases} / 4);
  ShaderBench bench;
  const std::vector<glm::vec4> outputs = bench.run(kBody, frame_of(1000, 1000, 1000), 4, 2, inputs_, kFiles);
  std::vector<double> depth;
  std::vector<double> normal;
  for (size_t i = 0; i < hits_.size(); ++i) {
    depth.push_back(std::abs(double{outputs[2 * i].x} - hits_[i].t));
    const glm::dvec3 drawn = glm::normalize(glm::dvec3(glm::vec3(outputs[2 * i + 1])));
    const double sine = glm::length(glm::cross(drawn, hits_[i].normal));
    normal.push_back(std::atan2(sine, glm::dot(drawn, hits_[i].normal)) * 180 / std::numbers::pi);
  }
  std::cout << bend.name << ": " << quantile(depth) << " radii, " << quantile(normal) << " degrees\n";
  EXPECT_LE(quantile(depth), bend.depth);
  EXPECT_LE(quantile(normal), bend.normal);
}

constexpr surfel::Curvature kSphere{0.6, 0, 0.6};
constexpr surfel::Curvature kCylinder{0.4, 0.3, 0.225};
constexpr surfel::Curvature kSaddle{0.5, 0.2, -0.5};

INSTANTIATE_TEST_SUITE_P(
    Shapes, OsculatingSurfaces,
    ::testing::Values(Bend{"PlaneAt30", {}, 30, 1.5e-5, 1e-5}, Bend{"SphereBeforeTheEye", kSphere, 1.2, 1e-5, 4e-4},
                      Bend{"SphereAt30", kSphere, 30, 4e-5, 1.5e-3}, Bend{"CylinderAt30", kCylinder, 30, 6e-5, 2e-3},
                      Bend{"SaddleAt30", kSaddle, 30, 4e-5, 1.5e-3}, Bend{"SphereAt1000", kSphere, 1e3, 2e-3, 0.06},
                      Bend{"SaddleAt1000", kSaddle, 1e3, 1.5e-3, 0.05}),
    [](const auto& bend) { return std::string(bend.param.name); });

}  // namespace
}  // namespace surfcast::testing
