#include "simplify/smooth_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <random>

#include "simplify/point_tree.h"

namespace surfcast::testing {
namespace {

using simplify::Near;
using simplify::PointTree;
using simplify::Sample;

constexpr double kBumps = 0.035;
constexpr double kWave = 9;

std::vector<glm::dvec3> positions_of(const std::vector<Sample>& samples) {
  std::vector<glm::dvec3> positions;
  positions.reserve(samples.size());
  for (const Sample& s : samples) positions.push_back(s.position);
  return positions;
}

/// How many of the samples are left if each takes all within `distance`.
std::vector<uint32_t> thinned(const std::vector<Sample>& samples, const PointTree& tree, double distance) {
  std::vector<bool> taken(samples.size());
  std::vector<uint32_t> left;
  std::vector<Near> near;
  for (uint32_t i = 0; i < samples.size(); ++i) {
    if (taken[i]) continue;
    left.push_back(i);
    tree.within(samples[i].position, distance, near);
    for (const Near& n : near) taken[n.point] = true;
  }
  return left;
}

}  // namespace

ImplicitSurface torus() {
  const auto around = [](const glm::dvec3& p) { return std::max(glm::length(glm::dvec2(p)), 1e-12); };
  return {"torus", [around](const glm::dvec3& p) { return glm::length(glm::dvec2(around(p) - 1, p.z)) - 0.4; },
          [around](const glm::dvec3& p) {
            const double r = around(p);
            return glm::dvec3(p.x * (r - 1) / r, p.y * (r - 1) / r, p.z);
          },
          1, 1.4};
}

ImplicitSurface bumpy_sphere() {
  const auto bumps = [](const glm::dvec3& p) {
    return std::sin(kWave * p.x) + std::sin(kWave * p.y) + std::sin(kWave * p.z);
  };
  return {"bumpy sphere", [bumps](const glm::dvec3& p) { return 0.55 * (glm::length(p) - 1 - kBumps * bumps(p)); },
          [](const glm::dvec3& p) {
            return p / std::max(glm::length(p), 1e-12) -
                   kBumps * kWave * glm::dvec3(std::cos(kWave * p.x), std::cos(kWave * p.y), std::cos(kWave * p.z));
          },
          0.35, 1.12};
}

ImplicitSurface box() {
  return {"box",
          [](const glm::dvec3& p) {
            const glm::dvec3 a = glm::abs(p) - 0.7;
            return std::max({a.x, a.y, a.z});
          },
          [](const glm::dvec3& p) {
            const glm::dvec3 a = glm::abs(p);
            const int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
            glm::dvec3 n(0);
            n[axis] = p[axis] < 0 ? -1 : 1;
            return n;
          },
          1, 0.72};
}

ImplicitSurface blob() {
  struct Ball {
    glm::dvec3 centre;
    double width;
  };
  static constexpr std::array<Ball, 4> kBalls{Ball{{-0.45, -0.1, -0.2}, 0.55}, Ball{{0.4, -0.3, 0.1}, 0.5},
                                              Ball{{0.1, 0.5, -0.1}, 0.45}, Ball{{0, 0, 0.55}, 0.5}};
  // A slope of exp(-r^2 / w^2) is at most sqrt(2 / e) / w.
  constexpr double kSlope = 0.858 * (1 / 0.55 + 2 / 0.5 + 1 / 0.45);
  const auto density = [](const glm::dvec3& p) {
    double sum = 0;
    for (const Ball& b : kBalls) sum += std::exp(-glm::dot(p - b.centre, p - b.centre) / (b.width * b.width));
    return sum;
  };
  return {"blob", [density](const glm::dvec3& p) { return (0.5 - density(p)) / kSlope; },
          [](const glm::dvec3& p) {
            glm::dvec3 outwards(0);
            for (const Ball& b : kBalls) {
              const glm::dvec3 d = p - b.centre;
              outwards += d * (std::exp(-glm::dot(d, d) / (b.width * b.width)) / (b.width * b.width));
            }
            return outwards;
          },
          0.5, 1.3};
}

ImplicitSurface spring() {
  static constexpr double kRadius = 0.75;
  constexpr double kTube = 0.16;
  static constexpr double kRise = 0.5 / (2 * std::numbers::pi);  // for an angle of 1
  static constexpr double kLast = 3 * std::numbers::pi;
  const auto centre = [](double t) { return glm::dvec3(kRadius * std::cos(t), kRadius * std::sin(t), kRise * t); };
  // The nearest point of the helix: Newton's method from the angle of the point, in each turn.
  const auto nearest = [centre](const glm::dvec3& p) {
    const double angle = std::atan2(p.y, p.x);
    glm::dvec3 best = centre(0);
    for (int turn = -2; turn <= 2; ++turn) {
      double t = std::clamp(angle + 2 * std::numbers::pi * turn, -kLast, kLast);
      for (int i = 0; i < 8; ++i) {
        const double along = kRadius * (p.x * std::sin(t) - p.y * std::cos(t)) - kRise * (p.z - kRise * t);
        const double slope = kRadius * (p.x * std::cos(t) + p.y * std::sin(t)) + kRise * kRise;
        t = std::clamp(t - along / std::max(slope, 0.1), -kLast, kLast);
      }
      if (glm::distance(p, centre(t)) < glm::distance(p, best)) best = centre(t);
    }
    return best;
  };
  return {"spring", [nearest](const glm::dvec3& p) { return 0.9 * (glm::distance(p, nearest(p)) - kTube); },
          [nearest](const glm::dvec3& p) { return p - nearest(p); }, 0.9, 1.0};
}

ImplicitSurface open_saddle() {
  return {"open saddle",
          [](const glm::dvec3& p) { return (p.z - 0.3 * (p.x * p.x - p.y * p.y)) / 1.4; },
          [](const glm::dvec3& p) { return glm::dvec3(-0.6 * p.x, 0.6 * p.y, 1); },
          0.7,
          1,
          1};
}

glm::dvec3 normal_at(const ImplicitSurface& surface, const glm::dvec3& point) {
  return glm::normalize(surface.gradient(point));
}

std::vector<Sample> random_samples(const ImplicitSurface& surface, size_t count, uint32_t seed) {
  // Points of a thin shell, moved onto the surface: the shell is equally thick everywhere in units of the slope.
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-surface.extent, surface.extent);
  std::uniform_real_distribution<double> share(0, 1);
  constexpr double kShell = 0.01;
  std::vector<Sample> samples;
  while (samples.size() < count) {
    glm::dvec3 p(place(random), place(random), place(random));
    const double d = surface.distance(p);
    if (std::abs(d) > kShell * surface.least_slope) continue;
    // The gradient of `distance`: the stated one may be another multiple of it.
    const glm::dvec3 n = normal_at(surface, p);
    const double slope = (surface.distance(p + 1e-6 * n) - surface.distance(p - 1e-6 * n)) / 2e-6;
    if (share(random) * 1.5 > slope) continue;
    for (int i = 0; i < 20; ++i) p -= surface.distance(p) / slope * normal_at(surface, p);
    if (surface.beyond_border(p) <= 0) samples.push_back({p, normal_at(surface, p)});
  }
  return samples;
}

void add_noise(std::vector<Sample>& samples, double spacing, double shift, double degrees, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const double turn = degrees * std::numbers::pi / 180 / std::sqrt(2.0);
  for (Sample& s : samples) {
    s.position += shift * spacing * normal(random) * s.normal;
    const surfel::TangentFrame frame = surfel::tangent_frame(s.normal);
    s.normal = glm::normalize(s.normal + turn * (normal(random) * frame.u + normal(random) * frame.v));
  }
}

std::vector<uint32_t> even_subset(const std::vector<Sample>& samples, size_t count) {
  const std::vector<glm::dvec3> positions = positions_of(samples);
  const PointTree tree(positions);
  double low = 0;
  double high = 2;
  for (int i = 0; i < 24; ++i) {
    const double middle = 0.5 * (low + high);
    (thinned(samples, tree, middle).size() > count ? low : high) = middle;
  }
  return thinned(samples, tree, high);
}

double spacing_of(const std::vector<Sample>& samples, const std::vector<uint32_t>& subset) {
  std::vector<glm::dvec3> centres;
  for (const uint32_t i : subset) centres.push_back(samples[i].position);
  const PointTree tree(centres);
  std::vector<Near> near;
  double sum = 0;
  for (const glm::dvec3& c : centres) {
    double reach = 0.01;
    do {
      tree.within(c, reach *= 1.2, near);
    } while (near.size() < 7);
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.square < b.square; });
    for (size_t i = 1; i < 7; ++i) sum += std::sqrt(near[i].square) / 6;
  }
  return sum / static_cast<double>(centres.size()) / 1.08;
}

surfel::SurfelCloud surfels_of(const std::vector<Sample>& samples, double radius) {
  surfel::SurfelCloud cloud;
  cloud.oriented = true;
  for (const Sample& s : samples) {
    cloud.positions.push_back(s.position);
    cloud.normals.emplace_back(s.normal);
    cloud.radii.push_back(static_cast<float>(radius));
    cloud.weights.push_back(1);
  }
  cloud.sources = {{"", 0, cloud.size(), std::nullopt}};
  return cloud;
}

}  // namespace surfcast::testing
