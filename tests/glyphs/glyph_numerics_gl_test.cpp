// Silhouettes, depths and normals of ellipsoids in the single precision of the device, beside double precision, for any
// elongation and distance.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <iostream>
#include <numbers>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "numerics/shader_bench.h"

namespace surfcast {
namespace {

constexpr int kCases = 4000;
constexpr double kRadius = 50;  // pixels, of the largest semi-axis
constexpr float kHalf = 1000;   // half the picture's side, pixels
constexpr double kQuantile = 0.999;

/// A shape, the distance of the eye in its largest semi-axes, and the errors that are allowed.
struct Case {
  const char* name;
  glm::dvec3 semi;
  double distance;
  double silhouette;  ///< pixels
  double depth;       ///< largest semi-axes
  double normal;      ///< degrees
};

/// An ellipsoid of single precision in the camera frame, with rays in double precision.
class Exact {
 public:
  Exact(const glm::vec3& centre, const glm::mat3& axes, const glm::vec3& semi, double eta)
      : eta_(eta), inverse_(glm::inverse(matrix(axes, semi))), eye_(-inverse_ * glm::dvec3(centre)) {}

  [[nodiscard]] glm::dvec3 ray(const glm::dvec2& pixel) const {
    return {(pixel.x - double{kHalf}) / eta_, (double{kHalf} - pixel.y) / eta_, 1};
  }
  /// Square of the distance of a pixel's ray from the centre, where the ellipsoid is the unit sphere.
  [[nodiscard]] double distance(const glm::dvec2& pixel) const {
    const glm::dvec3 v = inverse_ * ray(pixel);
    const glm::dvec3 beside = glm::cross(eye_, v);
    return glm::dot(beside, beside) / glm::dot(v, v);
  }
  /// Depth and normal of the first hit.
  [[nodiscard]] std::pair<double, glm::dvec3> hit(const glm::dvec2& pixel) const {
    const glm::dvec3 v = inverse_ * ray(pixel);
    const double vv = glm::dot(v, v);
    const glm::dvec3 closest = glm::cross(v, glm::cross(eye_, v)) / vv;
    const double half = std::sqrt(std::max(1 - glm::dot(closest, closest), 0.0) / vv);
    return {-glm::dot(eye_, v) / vv - half, glm::normalize(glm::transpose(inverse_) * (closest - half * v))};
  }

 private:
  static glm::dmat3 matrix(const glm::mat3& axes, const glm::vec3& semi) {
    glm::dmat3 a(axes);
    for (int i = 0; i < 3; ++i) a[i] *= double{semi[i]};
    return a;
  }

  double eta_;
  glm::dmat3 inverse_;
  glm::dvec3 eye_;
};

/// What the device is asked for each ellipsoid.
struct Question {
  Exact exact;
  glm::dvec2 border;   ///< a place on the silhouette
  glm::dvec2 outward;  ///< unit, square to it
  glm::dvec2 inside;
};

glm::dvec2 rounded(const glm::dvec2& v) {
  return glm::dvec2(glm::vec2(v));
}

/// The place on a line from the centre where the silhouette is.
std::optional<glm::dvec2> find_border(const Exact& exact, const glm::dvec2& centre, const glm::dvec2& along) {
  double low = 0;
  double high = 1e5;
  if (exact.distance(centre) >= 1 || exact.distance(centre + high * along) <= 1) return std::nullopt;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (exact.distance(centre + middle * along) < 1 ? low : high) = middle;
  }
  return centre + low * along;
}

glm::dvec2 gradient(const Exact& exact, const glm::dvec2& at) {
  constexpr double kStep = 1e-4;
  const auto slope = [&](const glm::dvec2& d) {
    return exact.distance(at + kStep * d) - exact.distance(at - kStep * d);
  };
  return glm::dvec2(slope({1, 0}), slope({0, 1}));
}

constexpr const char* kBody = R"(
  Ellipsoid e;
  e.c = in_[0].xyz;
  e.axes = mat3(in_[1].xyz, in_[2].xyz, in_[3].xyz);
  e.a = vec3(in_[1].w, in_[2].w, in_[3].w);
  mat3 rows = rows_of(e);
  Seen s;
  EllipsoidHit hit = hit_of(e, rows, s);
  vec4 before = hit_terms(hit, place_of(hit, in_[4].xy));
  vec4 behind = hit_terms(hit, place_of(hit, in_[4].zw));
  out_[0] = vec4(length(before.xy) / before.z, length(behind.xy) / behind.z, 0.0, 0.0);
  vec4 terms = hit_terms(hit, place_of(hit, in_[5].xy));
  out_[0].z = 1.0 / (hit.depth * (terms.z + hit.u * terms.w));
  out_[0].w = terms.w;
  out_[1] = vec4(hit_normal(hit, record_normals(normals_of(e), s), terms), 0.0);
  vec2 low, high;
  bounds_of(e, rows, low, high);
  out_[2] = vec4(low, high);
)";
constexpr std::array kFiles{"ellipsoid/record.glsl", "ellipsoid/geometry.glsl"};
constexpr int kIns = 6;
constexpr int kOuts = 3;

double quantile(std::vector<double> errors) {
  std::ranges::sort(errors);
  return errors[static_cast<size_t>(kQuantile * static_cast<double>(errors.size() - 1))];
}

glm::vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> part(0, 1);
  const float x = part(random);
  const float y = part(random);
  const float z = part(random);
  return glm::normalize(glm::vec3(x, y, z));
}

class EllipsoidNumerics : public ::testing::TestWithParam<Case> {
 protected:
  /// Adds an ellipsoid, unless its silhouette is too small for a question.
  void add(const Case& c, double eta) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double turn = std::numbers::pi * unit(random_);
    const glm::mat3 axes(glm::mat3_cast(glm::angleAxis(static_cast<float>(turn), random_direction(random_))));
    const glm::dvec2 aside = 1600.0 * glm::dvec2(unit(random_) - 0.5, unit(random_) - 0.5) / eta;
    const double z = c.distance / std::sqrt(1 + glm::dot(aside, aside));
    const glm::vec3 centre(glm::dvec3(z * aside, z));
    const Exact exact(centre, axes, glm::vec3(c.semi), eta);
    const glm::dvec3 centre_ray = glm::dvec3(centre) / double{centre.z};
    const glm::dvec2 middle(double{kHalf} + eta * centre_ray.x, double{kHalf} - eta * centre_ray.y);
    const double angle = 2 * std::numbers::pi * unit(random_);
    const auto border = find_border(exact, middle, {std::cos(angle), std::sin(angle)});
    if (!border || glm::length(*border - double{kHalf}) > double{kHalf}) return;
    const glm::dvec2 outward = glm::normalize(gradient(exact, *border));
    const glm::dvec2 inside = rounded(middle + 0.98 * unit(random_) * (*border - middle));
    if (exact.distance(inside) > 0.99) return;
    questions_.push_back({exact, *border, outward, inside});
    inputs_.emplace_back(centre, 0);
    for (int i = 0; i < 3; ++i) inputs_.emplace_back(axes[i], static_cast<float>(c.semi[i]));
    inputs_.emplace_back(glm::vec2(*border), glm::vec2(*border + 0.125 * outward));
    inputs_.emplace_back(glm::vec2(inside), 0, 0);
  }

  std::mt19937 random_{11};
  std::vector<Question> questions_;
  std::vector<glm::vec4> inputs_;
};

TEST_P(EllipsoidNumerics, AgreeWithDoublePrecision) {
  const Case& c = GetParam();
  const double eta = kRadius * c.distance;
  for (int i = 0; i < kCases; ++i) add(c, eta);
  ASSERT_GT(questions_.size(), size_t{kCases} / 50);
  testing::ShaderBench bench;
  const auto frame = testing::frame_of(static_cast<float>(eta), 2 * kHalf, 2 * kHalf);
  const std::vector<glm::vec4> outputs = bench.run(kBody, frame, kIns, kOuts, inputs_, kFiles);
  ASSERT_EQ(outputs.size(), questions_.size() * kOuts);
  std::vector<double> silhouette;
  std::vector<double> depth;
  std::vector<double> normal;
  for (size_t i = 0; i < questions_.size(); ++i) {
    const Question& question = questions_[i];
    const glm::vec4 first = outputs[kOuts * i];
    // Pixels are of single precision themselves: q at the place on the silhouette that was asked.
    const glm::dvec2 asked = rounded(question.border);
    const double moved = glm::dot(asked - question.border, question.outward);
    const double slope = (double{first.y} - double{first.x}) /
                         glm::dot(rounded(question.border + 0.125 * question.outward) - asked, question.outward);
    silhouette.push_back(std::abs((double{first.x} - 1) / slope - moved));
    const auto [z, n] = question.exact.hit(question.inside);
    depth.push_back(std::abs(double{first.z} - z));
    const glm::dvec3 drawn = glm::normalize(glm::dvec3(glm::vec3(outputs[kOuts * i + 1])));
    normal.push_back(std::atan2(glm::length(glm::cross(drawn, n)), glm::dot(drawn, n)) * 180 / std::numbers::pi);
    const glm::dvec4 bounds(outputs[kOuts * i + 2]);
    EXPECT_TRUE(question.border.x >= bounds.x && question.border.y >= bounds.y && question.border.x <= bounds.z &&
                question.border.y <= bounds.w)
        << "outside of the bounds";
  }
  std::cout << c.name << ": " << quantile(silhouette) << " px, " << quantile(depth) << " radii, " << quantile(normal)
            << " degrees\n";
  EXPECT_LE(quantile(silhouette), c.silhouette);
  EXPECT_LE(quantile(depth), c.depth);
  EXPECT_LE(quantile(normal), c.normal);
}

constexpr Case plain(const char* name, const glm::dvec3& semi, double distance) {
  return {name, semi, distance, 1e-3, 1e-4, 0.1};
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, EllipsoidNumerics,
    // (1.003e-3 pixels on an NVIDIA H200.)
    ::testing::Values(Case{"SphereBeforeTheEye", {1, 1, 1}, 1.05, 1.1e-3, 1e-4, 0.1}, plain("SphereAt3", {1, 1, 1}, 3),
                      plain("SphereAt30", {1, 1, 1}, 30), plain("PancakeOf10At3", {1, 0.8, 0.1}, 3),
                      plain("NeedleOf10At3", {1, 0.1, 0.1}, 3), plain("PancakeOf1000At3", {1, 0.8, 1e-3}, 3),
                      plain("NeedleOf1000At3", {1, 1e-3, 1e-3}, 3), plain("PancakeOf1000At30", {1, 0.8, 1e-3}, 30),
                      plain("NeedleOf1000At30", {1, 1e-3, 1e-3}, 30),
                      Case{"PancakeOfAMillionAt30", {1, 0.8, 1e-6}, 30, 5e-4, 6e-3, 5e-5},
                      Case{"NeedleOf1000At1000", {1, 1e-3, 1e-3}, 1e3, 7e-4, 9e-4, 4},
                      Case{"SphereAt100000", {1, 1, 1}, 1e5, 6e-4, 7e-2, 5e-3}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace
}  // namespace surfcast
