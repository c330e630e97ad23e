// Compares the functions of the shaders, run on the device for ranges of parameters, with the same formulas in double
// precision. Differences are in units that matter in a picture: weights within the cutoff, pixels, shares.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <numbers>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "numerics/degree.h"
#include "numerics/shader_bench.h"
#include "reference/resampling_filter.h"
#include "shared/kernel.h"

namespace surfcast::testing {
namespace {

/// A surfel, its view and a pixel, in numbers that are exact in single precision.
struct Sighting {
  glm::vec3 o{0};
  glm::vec3 n{0};
  float radius = 0;
  glm::vec2 v{0};  ///< pixels from the projected centre, y up
  double degrees = 0;
  double s = 0;  ///< standard deviation of the kernel seen from the front, pixels

  [[nodiscard]] glm::dvec3 ray(double eta) const {
    return {double{o.x} / o.z + v.x / eta, double{o.y} / o.z + v.y / eta, 1};
  }
};

/// A unit normal at o with an angle of incidence of `degrees`, facing the eye.
glm::dvec3 normal_at(const glm::dvec3& o, double degrees, double turn) {
  const glm::dvec3 view = glm::normalize(o);
  const glm::dvec3 side = glm::normalize(glm::cross(view, glm::dvec3(0.3, 1, 0.1)));
  const glm::dvec3 across = std::cos(turn) * side + std::sin(turn) * glm::cross(view, side);
  return std::sin(degrees * kDegree) * across - std::cos(degrees * kDegree) * view;
}

/// A view: pixels per unit of tangent, and the tangent at its corners.
struct View {
  double eta;
  double widest;
};
/// From 170 degrees to a tenth of one in a picture 8192 pixels high.
constexpr View kViews[] = {{20, 15}, {250, 1.5}, {2000, 0.5}, {3e5, 2e-3}, {5e6, 2e-3}};

/// Values from `least` to `most`, in steps of a factor of sqrt(10).
std::vector<double> half_decades(double least, double most) {
  std::vector<double> values{least};
  while (values.back() * std::sqrt(10.0) <= most) values.push_back(values.back() * std::sqrt(10.0));
  return values;
}

/// Surfels with s up to `most` pixels, at all angles of incidence and anywhere in the view.
std::vector<Sighting> sweep(const View& view, double most) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Sighting> all;
  for (const double degrees : {0.0, 1e-4, 1.0, 30.0, 60.0, 85.0, 89.0, 89.9, 89.99, 89.999, 89.9999, 90.0}) {
    for (const double s : half_decades(1e-5, most)) {
      for (int k = 0; k < 40; ++k) {
        const double z = std::exp2(12 * uniform(random));
        const glm::dvec3 o = z * glm::dvec3(view.widest * uniform(random), view.widest * uniform(random), 1);
        const double reach = 3 * std::hypot(s, 1);
        all.push_back({glm::vec3(o), glm::vec3(normal_at(o, degrees, 3 * uniform(random))),
                       static_cast<float>(s * z / view.eta / SURFCAST_KERNEL_SIGMA),
                       glm::vec2(reach * uniform(random), reach * uniform(random)), degrees, s});
      }
    }
  }
  return all;
}

std::vector<glm::vec4> inputs_of(const std::vector<Sighting>& all, double eta) {
  std::vector<glm::vec4> inputs;
  for (const Sighting& at : all) {
    const glm::dvec3 d = at.ray(eta);
    inputs.emplace_back(at.o, at.radius);
    inputs.emplace_back(at.n, 0);
    inputs.emplace_back(at.v, static_cast<float>(d.x), static_cast<float>(d.y));
  }
  return inputs;
}

class FilterGLTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { bench_ = std::make_unique<ShaderBench>(); }
  static void TearDownTestSuite() { bench_.reset(); }

  static std::vector<glm::vec4> run(const std::string& body, const View& view, const std::vector<Sighting>& all) {
    return bench_->run(body, frame_of(static_cast<float>(view.eta), 512, 512), 3, 1, inputs_of(all, view.eta));
  }
  static inline std::unique_ptr<ShaderBench> bench_;
};

constexpr double kPrefilters[] = {1, 1e-4};  ///< variances, pixels squared

/// Permitted error of a weight: the relative error of rounding, plus the effect of turning the normal by `radians`.
/// Edge-on, n.d is a difference of numbers as large as |d|, so its error cannot be smaller with rounded inputs.
double allowed_of(double gain, double relative, double radians, const glm::dvec3& n, const glm::dvec3& d) {
  return gain * (relative + radians * glm::length(d) / std::max(std::abs(glm::dot(n, d)), 1e-300));
}

/// The largest ratio of the error to the permitted error over all cases.
class Worst {
 public:
  explicit Worst(std::string what) : what_(std::move(what)) {}
  ~Worst() { std::cout << "[ measured ] " << what_ << ": " << worst_ << " of what is allowed\n"; }
  Worst(const Worst&) = delete;
  Worst& operator=(const Worst&) = delete;
  void expect(double error, double allowed, const Sighting& at) {
    EXPECT_LE(error, allowed) << what_ << " at " << at.degrees << " degrees, s = " << at.s;
    worst_ = std::max(worst_, error / allowed);
  }

 private:
  std::string what_;
  double worst_ = 0;
};

double weight_of(double gain, double r2) {
  return gain * std::exp(-0.5 * r2);
}

TEST_F(FilterGLTest, TheExactFilterHoldsAtEveryAngleAndSize) {
  const std::string body =
      "  float s = frontal_deviation(float(SURFCAST_KERNEL_SIGMA) * in_[0].w, in_[0].z);\n"
      "  out_[0].xy = filter_at(in_[1].xyz, in_[2].zw, in_[2].xy, s, 1.0);\n"
      "  out_[0].zw = filter_at(in_[1].xyz, in_[2].zw, in_[2].xy, s, 1e-4);\n";
  for (const View& view : kViews) {
    const std::vector<Sighting> all = sweep(view, 0.2 * view.eta);
    const auto out = run(body, view, all);
    Worst worst("exact filter, eta " + std::to_string(view.eta));
    for (size_t i = 0; i < out.size(); ++i) {
      for (const int k : {0, 1}) {
        const auto splat = reference::Splat::make(glm::dvec3(all[i].o), glm::dvec3(all[i].n), all[i].radius, view.eta,
                                                  std::sqrt(kPrefilters[k]), {});
        ASSERT_TRUE(splat.has_value());
        const glm::dvec3 d = all[i].ray(view.eta);
        const reference::Fragment expected = splat->fragment(d);
        worst.expect(std::abs(weight_of(out[i][2 * k + 1], out[i][2 * k]) - weight_of(expected.gain, expected.r2)),
                     allowed_of(expected.gain, 2e-6, 2e-7, glm::dvec3(all[i].n), d), all[i]);
      }
    }
  }
}

/// v^T S^-1 v of the ellipse of the kernel at the surfel's centre.
double ellipse_r2(const Sighting& at, double eta, double prefilter) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(at.n));
  const glm::dvec2 c = glm::dvec2(at.o) / double{at.o.z};
  const glm::dvec3 p = glm::cross(glm::dvec3(1, 0, -c.x), n);
  const glm::dvec3 q = glm::cross(glm::dvec3(0, 1, -c.y), n);
  const double s = SURFCAST_KERNEL_SIGMA * at.radius * eta / at.o.z;
  const double area = s * s * (glm::dot(glm::dvec2(n), c) + n.z);
  const double xx = s * s * glm::dot(p, p) + prefilter;
  const double yy = s * s * glm::dot(q, q) + prefilter;
  const double xy = s * s * glm::dot(p, q);
  const double det = area * area + prefilter * (xx + yy - prefilter);
  const glm::dvec2 v(at.v);
  return (yy * v.x * v.x - 2 * xy * v.x * v.y + xx * v.y * v.y) / det;
}

TEST_F(FilterGLTest, SmallSplatsKeepTheirEllipseInHalfPrecision) {
  const std::string body =
      "  float s = frontal_deviation(float(SURFCAST_KERNEL_SIGMA) * in_[0].w, in_[0].z);\n"
      "  for (int k = 0; k < 2; ++k) {\n"
      "    ScreenVariance v = screen_variance(in_[1].xyz, in_[0].xy / in_[0].z, s, k == 0 ? 1.0 : 1e-4);\n"
      "    SmallSplat splat = SmallSplat(vec2(0.0), 1.0, vec2(0.0), inverse_factor(v.s, v.det), 9.0, 0.0, 1.0, 0u);\n"
      "    uvec4 a, b;\n"
      "    encode_small(splat, a, b);\n"
      "    vec3 f = decode_small(a, b).factor;\n"
      "    vec2 d = in_[2].xy * vec2(1.0, -1.0);\n"
      "    out_[0][k] = pow(f.x * d.x + f.y * d.y, 2.0) + pow(f.z * d.y, 2.0);\n"
      "    f = splat.factor;\n"
      "    out_[0][k + 2] = pow(f.x * d.x + f.y * d.y, 2.0) + pow(f.z * d.y, 2.0);\n"
      "  }\n";
  // Half precision has a relative error of 2^-11 in each factor. Along an ellipse 24 pixels long and one pixel wide,
  // terms of size 24 cancel: the error of r is at most 24 * 2 / 2048, that of a weight 1.5 %. Without prefilter an
  // ellipse may be 0.01 pixels wide, but the brightness of ellipses thinner than half a pixel is arbitrary anyway.
  constexpr double kHalf[] = {0.015, 0.1};
  for (const View& view : kViews) {
    const std::vector<Sighting> all = sweep(view, std::min(8.0, 0.2 * view.eta));
    const auto out = run(body, view, all);
    Worst halved("ellipse in half precision, eta " + std::to_string(view.eta));
    Worst single("ellipse in single precision, eta " + std::to_string(view.eta));
    for (size_t i = 0; i < out.size(); ++i) {
      for (const int k : {0, 1}) {
        const double expected = weight_of(1, ellipse_r2(all[i], view.eta, kPrefilters[k]));
        halved.expect(std::abs(weight_of(1, out[i][k]) - expected), kHalf[k], all[i]);
        single.expect(std::abs(weight_of(1, out[i][k + 2]) - expected), 2e-5, all[i]);
      }
    }
  }
}

/// Bounds of the projected disc in d.xy, from points on its rim.
struct DiscBounds {
  glm::dvec2 low{1e300};
  glm::dvec2 high{-1e300};
};
constexpr int kRimPoints = 1024;

DiscBounds rim_bounds(const Sighting& at, double extent) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(at.n));
  const glm::dvec3 a = glm::normalize(glm::cross(n, std::abs(n.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 b = glm::cross(n, a);
  DiscBounds bounds;
  for (int i = 0; i < kRimPoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRimPoints;
    const glm::dvec3 p = glm::dvec3(at.o) + extent * (std::cos(angle) * a + std::sin(angle) * b);
    bounds.low = glm::min(bounds.low, glm::dvec2(p) / p.z);
    bounds.high = glm::max(bounds.high, glm::dvec2(p) / p.z);
  }
  return bounds;
}

TEST_F(FilterGLTest, BoundsOfProjectedDiscsTouchTheirRims) {
  const std::string body =
      "  vec2 low, high;\n"
      "  projected_disc_bounds(in_[0].xyz, in_[1].xyz, surfel_extent(in_[0].w), low, high);\n"
      "  out_[0] = vec4(low, high);\n";
  for (const View& view : kViews) {
    const std::vector<Sighting> all = sweep(view, 0.2 * view.eta);
    const auto out = run(body, view, all);
    Worst worst("bounds, eta " + std::to_string(view.eta));
    for (size_t i = 0; i < out.size(); ++i) {
      const double extent = std::max(3 * SURFCAST_KERNEL_SIGMA, SURFCAST_VISIBILITY_RADIUS) * all[i].radius;
      const DiscBounds expected = rim_bounds(all[i], extent);
      const glm::dvec2 off = glm::max(glm::abs(glm::dvec2(out[i].x, out[i].y) - expected.low),
                                      glm::abs(glm::dvec2(out[i].z, out[i].w) - expected.high));
      const glm::dvec2 size = expected.high - expected.low;
      // Sum of the errors in pixels: of the rim between two of its points, of single precision at this distance from
      // the centre, and of the disc's slant, which is a square root that is inaccurate edge-on.
      const double allowed =
          view.eta * (2e-5 * std::max(size.x, size.y) + 1e-6 * view.widest + 1e-4 * extent / all[i].o.z) + 1e-3;
      worst.expect(view.eta * std::max(off.x, off.y), allowed, all[i]);
    }
  }
}

/// The weight of term i: any size from 2^-24 to 1, exact in single precision.
uint32_t hash_of(uint32_t i) {
  i = (i ^ (i >> 16)) * 0x7feb352dU;
  i = (i ^ (i >> 15)) * 0x846ca68bU;
  return i ^ (i >> 16);
}
double term(uint32_t i) {
  const uint32_t hash = hash_of(i);
  return std::ldexp(static_cast<double>((hash >> 16) + 1), -16 - static_cast<int>(hash & 7U));
}

TEST_F(FilterGLTest, SumsOfManyTermsLoseLessThanTheirLastBits) {
  constexpr uint32_t kTerms = 60000;
  const std::string body =
      "  float unit = fixed_unit(1.0);\n"
      "  FixedSum sum = fixed_zero();\n"
      "  for (uint i = 0u; i < " +
      std::to_string(kTerms) +
      "u; ++i) {\n"
      "    uint h = i;\n"
      "    h = (h ^ (h >> 16)) * 0x7feb352du; h = (h ^ (h >> 15)) * 0x846ca68bu; h = h ^ (h >> 16);\n"
      "    fixed_add(sum, ldexp(float((h >> 16) + 1u), -16 - int(h & 7u)) * unit);\n"
      "    if (i % uint(SURFCAST_CARRY_INTERVAL) == uint(SURFCAST_CARRY_INTERVAL) - 1u) fixed_carry(sum);\n"
      "  }\n"
      "  fixed_carry(sum);\n"
      "  out_[0] = vec4(fixed_value(sum) / unit, unit, 0.0, 0.0);\n";
  const auto out = bench_->run(body, frame_of(100, 64, 64), 1, 1, std::vector<glm::vec4>(1));
  ASSERT_EQ(out.size(), 1U);
  double exact = 0;
  for (uint32_t i = 0; i < kTerms; ++i) exact += term(i);
  // Every term is truncated to the unit, 2^-24 of the largest term; the sum is rounded to single precision once.
  EXPECT_NEAR(out[0].x, exact, kTerms / double{out[0].y} + 2e-7 * exact);
}

TEST_F(FilterGLTest, GroupsAreInterleavedOnceEachAndEvenly) {
  constexpr std::array kFiles{"include/work_group.glsl"};
  for (const uint32_t count : {1U, 15U, 16U, 17U, 100U, 5000U}) {
    std::vector<glm::vec4> cases;
    for (uint32_t i = 0; i < count; ++i) cases.emplace_back(i, count, 0, 0);
    const std::string body = "  out_[0].x = float(interleaved(uint(in_[0].x), uint(in_[0].y)));\n";
    const auto out = bench_->run(body, frame_of(100, 64, 64), 1, 1, cases, kFiles);
    std::set<float> groups;
    double sum = 0;  // of the first half
    for (uint32_t i = 0; i < count; ++i) {
      groups.insert(out[i].x);
      if (i < count / 2) sum += out[i].x;
    }
    EXPECT_EQ(groups.size(), count);
    EXPECT_EQ(*groups.rbegin(), static_cast<float>(count - 1));
    if (count >= 100) {
      EXPECT_NEAR(sum / (count / 2), 0.5 * count, 0.08 * count) << count;
    }
  }
}

}  // namespace
}  // namespace surfcast::testing
