#include "reference/ellipsoid_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <random>

#include <tbb/parallel_for.h>

#include "base/contract.h"

namespace surfcast::reference {
namespace {

constexpr double kFlattest = 1e-7;  ///< least semi-axis, in largest ones

/// The slopes x / z between which an ellipsoid is seen, from its rows of x and z. None if there is no bound.
std::optional<glm::dvec2> slopes(double cx, const glm::dvec3& ax, double cz, const glm::dvec3& az) {
  const double h = cz * cz - glm::dot(az, az);
  if (!(h > 0 && cz > 0)) return std::nullopt;
  const double slope = cx / cz;
  const glm::dvec3 w = ax - slope * az;
  const double p = -glm::dot(w, az);
  const double a = p + (p < 0 ? -1 : 1) * std::sqrt(glm::dot(w, w) * h + p * p);
  if (a == 0) return glm::dvec2(slope);
  const glm::dvec2 t(a / h, -glm::dot(w, w) / a);
  return glm::dvec2(slope + std::min(t.x, t.y), slope + std::max(t.x, t.y));
}

struct Lattice {
  int samples;
  int width;  ///< samples, with the reach of the filter on all sides
  int height;

  [[nodiscard]] glm::dvec2 pixel(int x, int y) const {
    return glm::dvec2((x + 0.5) / samples, (y + 0.5) / samples) - double{kFilterReach};
  }
  /// Samples in a rectangle of pixels: first, and behind the last.
  [[nodiscard]] glm::ivec4 range(const glm::dvec4& bounds) const {
    const auto index = [&](double pixel, int most) {
      return static_cast<int>(std::clamp(samples * (pixel + kFilterReach), 0.0, double(most)));
    };
    return {index(bounds.x - 0.1, width), index(bounds.y - 0.1, height),
            std::min(index(bounds.z + 0.1, width) + 1, width), std::min(index(bounds.w + 0.1, height) + 1, height)};
  }
};

struct Prepared {
  RayEllipsoid ellipsoid;
  glm::ivec4 range;
  glm::dvec3 color;
};

std::vector<Prepared> prepare(std::span<const EllipsoidGlyph> glyphs, const geometry::CameraFrame& frame,
                              const Lattice& lattice) {
  std::vector<Prepared> prepared;
  for (const EllipsoidGlyph& glyph : glyphs) {
    const RayEllipsoid ellipsoid(glyph, frame);
    const std::optional<glm::dvec4> bounds = ellipsoid.bounds(frame);
    if (!bounds || ellipsoid.around_eye()) continue;
    prepared.push_back({ellipsoid, lattice.range(*bounds), glyph.color});
  }
  return prepared;
}

struct Nearest {
  double depth = std::numeric_limits<double>::infinity();
  glm::dvec3 normal{0};
  int glyph = -1;
};

void draw_row(const std::vector<Prepared>& glyphs, const geometry::CameraFrame& frame, const Lattice& lattice,
              const GlyphLight& light, int y, LightPicture& picture) {
  std::vector<Nearest> row(static_cast<size_t>(lattice.width));
  for (size_t g = 0; g < glyphs.size(); ++g) {
    const Prepared& glyph = glyphs[g];
    if (y < glyph.range.y || y >= glyph.range.w) continue;
    for (int x = glyph.range.x; x < glyph.range.z; ++x) {
      const std::optional<EllipsoidHit> hit = glyph.ellipsoid.hit(frame.ray(lattice.pixel(x, y)));
      if (!hit || hit->depth >= row[x].depth) continue;
      row[x] = {hit->depth, hit->normal, static_cast<int>(g)};
    }
  }
  for (int x = 0; x < lattice.width; ++x) {
    if (row[x].glyph < 0) continue;
    const glm::dvec3 d = frame.ray(lattice.pixel(x, y));
    const glm::dvec3 color = light(glyphs[static_cast<size_t>(row[x].glyph)].color, row[x].normal, d);
    picture.pixels[picture.index(x, y)] = glm::dvec4(color, 1);
  }
}

glm::dquat random_rotation(std::mt19937& random) {
  std::normal_distribution<double> part(0, 1);
  const double w = part(random);
  const double x = part(random);
  const double y = part(random);
  const double z = part(random);
  return glm::normalize(glm::dquat(w, x, y, z));
}

/// The rotation whose first axis is a unit vector.
glm::dquat rotation_along(const glm::dvec3& axis) {
  const glm::dvec3 aside = std::abs(axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 second = glm::normalize(glm::cross(axis, aside));
  return glm::quat_cast(glm::dmat3(axis, second, glm::cross(axis, second)));
}

/// Calls `place` at `side`^3 places of a lattice in the cube from -1 to 1.
void on_lattice(int side, const std::function<void(const glm::dvec3&)>& place) {
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) place((2.0 * glm::dvec3(x, y, z) + 1.0) / double(side) - 1.0);
    }
  }
}

/// The nearest point of three turns of a helix about the y axis, from a fine polygon, and its tangent.
std::pair<glm::dvec3, glm::dvec3> nearest_on_helix(const glm::dvec3& p) {
  constexpr int kPieces = 600;
  std::pair<glm::dvec3, glm::dvec3> best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kPieces; ++i) {
    const double s = 2.0 * i / kPieces - 1;
    const double angle = 3 * std::numbers::pi * s;
    const glm::dvec3 point(0.6 * std::cos(angle), 0.85 * s, 0.6 * std::sin(angle));
    if (glm::length(p - point) >= least) continue;
    least = glm::length(p - point);
    const double turn = 0.6 * 3 * std::numbers::pi;
    best = {point, glm::normalize(glm::dvec3(-turn * std::sin(angle), 0.85, turn * std::cos(angle)))};
  }
  return best;
}

void add_helix(EllipsoidScene& scene) {
  constexpr int kSide = 48;
  on_lattice(kSide, [&](const glm::dvec3& p) {
    const auto [point, tangent] = nearest_on_helix(p);
    const double distance = glm::length(p - point);
    if (distance > 0.2) return;
    const double shape = 0.3 + 0.5 * distance / 0.2;
    scene.glyphs.push_back({p, glm::dvec3(1, shape, 0.8 * shape) / double(kSide), rotation_along(tangent)});
  });
}

/// Glyphs of random directions on a lattice; `shape` makes their semi-axes relative to half a step.
void add_lattice(int side, std::mt19937& random, const std::function<glm::dvec3()>& shape, EllipsoidScene& scene) {
  on_lattice(side, [&](const glm::dvec3& p) {
    scene.glyphs.push_back({p, shape() / double(side), random_rotation(random)});
  });
}

glm::dvec3 descending(glm::dvec3 v) {
  std::array<double, 3> values{v.x, v.y, v.z};
  std::ranges::sort(values, std::greater<>());
  return {values[0], values[1], values[2]};
}

glm::dvec3 flattened(std::mt19937& random, double least, double most) {
  std::uniform_real_distribution<double> exponent(least, most);
  const double thin = std::pow(10.0, -exponent(random));
  const bool needle = std::uniform_int_distribution<int>(0, 1)(random) == 0;
  return needle ? glm::dvec3(1, thin, thin) : glm::dvec3(1, 0.8, thin);
}

void add_random(int count, std::mt19937& random, double size, EllipsoidScene& scene) {
  std::uniform_real_distribution<double> place(-1, 1);
  std::uniform_real_distribution<double> axis(0.2, 1);
  for (int i = 0; i < count; ++i) {
    const double x = place(random);
    const double y = place(random);
    const double z = place(random);
    const double a = axis(random);
    const double b = axis(random);
    const double c = axis(random);
    scene.glyphs.push_back({{x, y, z}, size * descending({a, b, c}), random_rotation(random)});
  }
}

}  // namespace

RayEllipsoid::RayEllipsoid(const EllipsoidGlyph& glyph, const geometry::CameraFrame& frame)
    : semi_(glm::max(glyph.values, glm::dvec3(kFlattest * glyph.values.x))), centre_(frame.to_camera(glyph.centre)) {
  const glm::dmat3 axes = glm::mat3_cast(glyph.rotation);
  for (int i = 0; i < 3; ++i) axes_[i] = frame.rotate(axes[i]);
  eye_ = -(glm::transpose(axes_) * centre_) / semi_;
  if (!glyph.sharpness) return;
  const glm::dvec3& v = glyph.values;
  const double sum = v.x + v.y + v.z;
  const double linear = std::pow(1 - (v.x - v.y) / sum, *glyph.sharpness);
  const double planar = std::pow(1 - 2 * (v.y - v.z) / sum, *glyph.sharpness);
  along_first_ = linear <= planar;
  e_ = along_first_ ? glm::dvec2(planar, linear) : glm::dvec2(linear, planar);
}

double RayEllipsoid::outside(const glm::dvec3& p) const {
  const glm::dvec3 a = glm::abs(along_first_ ? glm::dvec3(p.y, p.z, p.x) : p);
  const double around = std::pow(a.x, 2 / e_->x) + std::pow(a.y, 2 / e_->x);
  return std::pow(around, e_->x / e_->y) + std::pow(a.z, 2 / e_->y) - 1;
}

// Small steps over all of the ray in the ball, then bisection; the normal by differences.
std::optional<EllipsoidHit> RayEllipsoid::superquadric_hit(const glm::dvec3& d) const {
  constexpr int kSteps = 200;
  const glm::dvec3 v = glm::transpose(axes_) * d / semi_;
  const double speed = glm::length(v);
  const double middle = -glm::dot(eye_, v) / (speed * speed);
  const double reach = std::sqrt(3.0) / speed;
  if (distance_squared(d) > 3) return std::nullopt;
  const auto at = [&](double t) { return outside(eye_ + t * v); };
  const double first = std::max(middle - reach, 0.0);
  const double step = (middle + reach - first) / kSteps;
  for (int i = 1; i <= kSteps; ++i) {
    if (at(first + i * step) > 0) continue;
    double low = first + (i - 1) * step;
    double high = first + i * step;
    for (int k = 0; k < 50; ++k) (at(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    const glm::dvec3 p = eye_ + high * v;
    glm::dvec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 aside(0);
      aside[axis] = 1e-6;
      gradient[axis] = outside(p + aside) - outside(p - aside);
    }
    return EllipsoidHit{high, glm::normalize(axes_ * (gradient / semi_))};
  }
  return std::nullopt;
}

bool RayEllipsoid::around_eye() const {
  return glm::dot(eye_, eye_) <= 1;
}

double RayEllipsoid::distance_squared(const glm::dvec3& d) const {
  const glm::dvec3 v = glm::transpose(axes_) * d / semi_;
  const glm::dvec3 beside = glm::cross(eye_, v);
  return glm::dot(beside, beside) / glm::dot(v, v);
}

std::optional<EllipsoidHit> RayEllipsoid::hit(const glm::dvec3& d) const {
  if (e_) return superquadric_hit(d);
  const glm::dvec3 v = glm::transpose(axes_) * d / semi_;
  const glm::dvec3 beside = glm::cross(eye_, v);
  const double vv = glm::dot(v, v);
  const double inside = vv - glm::dot(beside, beside);
  if (inside < 0) return std::nullopt;
  const double t = (-glm::dot(eye_, v) - std::sqrt(inside)) / vv;
  if (t <= 0) return std::nullopt;
  const double half = std::sqrt(inside) / vv;
  const glm::dvec3 closest = glm::cross(v, glm::cross(eye_, v)) / vv;  // of the ray to the centre
  const glm::dvec3 p = closest - half * v;
  return EllipsoidHit{t, glm::normalize(axes_ * (p * (std::min({semi_.x, semi_.y, semi_.z}) / semi_)))};
}

std::optional<glm::dvec4> RayEllipsoid::bounds(const geometry::CameraFrame& frame) const {
  const double reach = e_ ? std::sqrt(3.0) : 1;
  const glm::dmat3 rows =
      reach * glm::transpose(glm::dmat3(semi_.x * axes_[0], semi_.y * axes_[1], semi_.z * axes_[2]));
  if (centre_.z + glm::length(rows[2]) <= 0) return std::nullopt;
  const auto x = slopes(centre_.x, rows[0], centre_.z, rows[2]);
  const auto y = slopes(centre_.y, rows[1], centre_.z, rows[2]);
  constexpr double kAll = 1e6;
  if (!x || !y) return glm::dvec4(-kAll, -kAll, kAll, kAll);
  const glm::dvec2 low = frame.project({x->x, y->y, 1});
  const glm::dvec2 high = frame.project({x->y, y->x, 1});
  return glm::dvec4(low, high);
}

glm::dvec3 glyph_headlight(const glm::dvec3& color, const glm::dvec3& n, const glm::dvec3& d) {
  return color * (0.1 + 0.9 * std::min(std::abs(glm::dot(n, glm::normalize(d))), 1.0));
}

LightPicture ellipsoid_picture(std::span<const EllipsoidGlyph> glyphs, const geometry::CameraFrame& frame, int samples,
                               const GlyphLight& light) {
  const Lattice lattice{samples, samples * (frame.width + 2 * kFilterReach),
                        samples * (frame.height + 2 * kFilterReach)};
  const std::vector<Prepared> prepared = prepare(glyphs, frame, lattice);
  LightPicture picture(lattice.width, lattice.height);
  tbb::parallel_for(0, lattice.height, [&](int y) { draw_row(prepared, frame, lattice, light, y, picture); });
  return reduced(picture, samples);
}

glm::dvec3 direction_color(const EllipsoidGlyph& glyph) {
  const double w = (glyph.values.x - glyph.values.y) / glyph.values.x;
  const glm::dvec3 code = 0.5 * (1 - w) + w * glm::abs(glm::mat3_cast(glyph.rotation)[0]);
  return linear_from_srgb(code);
}

EllipsoidScene make_ellipsoid_scene(const std::string& name) {
  EllipsoidScene scene;
  scene.camera = {{1.6, 1.3, 4.2}, {0, 0, 0}, {0, 1, 0}, 34};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  if (name == "helix") {
    add_helix(scene);
  } else if (name == "mixed") {
    add_lattice(
        14, random,
        [&] {
          const double a = 0.3 + 0.7 * unit(random);
          const double b = 0.3 + 0.7 * unit(random);
          return descending({1, a, b});
        },
        scene);
  } else if (name == "needles") {
    add_lattice(
        14, random, [&] { return flattened(random, 0, 3); }, scene);
  } else if (name == "extreme") {
    add_lattice(
        10, random, [&] { return 1.6 * flattened(random, 1, 6); }, scene);
  } else if (name == "overlap") {
    add_random(60, random, 0.5, scene);
  } else if (name == "close") {
    scene.camera = {{0.05, 0.1, 0.15}, {-0.6, -0.1, -0.5}, {0, 1, 0}, 60};
    add_random(300, random, 0.22, scene);
  } else {
    SURFCAST_EXPECTS(name == "far");
    scene.camera = {{1.6, 1.3, 4.2}, {0, 0, 0}, {0, 1, 0}, 120};
    scene.side = 256;
    add_lattice(
        46, random,
        [&] {
          return descending({1, 0.3 + 0.7 * unit(random), 0.3 + 0.7 * unit(random)});
        },
        scene);
  }
  for (EllipsoidGlyph& glyph : scene.glyphs) glyph.color = direction_color(glyph);
  return scene;
}

}  // namespace surfcast::reference
