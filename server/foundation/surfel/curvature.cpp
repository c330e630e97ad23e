#include "surfel/curvature.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "base/contract.h"

namespace surfcast::surfel {
namespace {

/// Normals above this z use the frame of the upper pole (see tangent_frame).
constexpr double kEquator = -1e-4;

double form(const Curvature& k, const glm::dvec2& q) {
  return glm::dot(q, k.times(q));
}

/// The surface seen from its other side.
OsculatingSurface turned(const OsculatingSurface& s) {
  return {s.centre, -s.normal, s.frame, {-s.curvature.uu, -s.curvature.uv, -s.curvature.vv}};
}

/// The quadratic of the ray's distance above the surface, a t^2 + b t + c, with t counted from the point of the ray
/// that is nearest to the centre: no term is a difference of large ones.
struct Entry {
  double nearest = 0;
  double a = 0;
  double b = 0;
  double c = 0;
};

Entry entry_of(const OsculatingSurface& s, const glm::dvec3& ray) {
  const double nearest = glm::dot(s.centre, ray) / glm::dot(ray, ray);
  const glm::dvec3 p = nearest * ray - s.centre;
  const glm::dvec2 q{glm::dot(s.frame.u, p), glm::dot(s.frame.v, p)};
  const glm::dvec2 d{glm::dot(s.frame.u, ray), glm::dot(s.frame.v, ray)};
  return {nearest, 0.5 * form(s.curvature, d), glm::dot(d, s.curvature.times(q)) + glm::dot(s.normal, ray),
          glm::dot(s.normal, p) + 0.5 * form(s.curvature, q)};
}

}  // namespace

TangentFrame tangent_frame(const glm::dvec3& normal) {
  const double sign = normal.z >= kEquator ? 1 : -1;
  const double a = -1 / (sign + normal.z);
  const double b = normal.x * normal.y * a;
  return {{1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
          {b, sign + normal.y * normal.y * a, -normal.y}};
}

double Curvature::largest() const {
  return 0.5 * (std::abs(uu + vv) + std::hypot(uu - vv, 2 * uv));
}

double OsculatingSurface::height(const glm::dvec3& point) const {
  return glm::dot(normal, point - centre) + 0.5 * form(curvature, place(point));
}

glm::dvec2 OsculatingSurface::place(const glm::dvec3& point) const {
  return {glm::dot(frame.u, point - centre), glm::dot(frame.v, point - centre)};
}

glm::dvec3 OsculatingSurface::normal_at(const glm::dvec2& place) const {
  const glm::dvec2 slope = curvature.times(place);
  const double along = std::sqrt(std::max(0.0, 1 - glm::dot(slope, slope)));
  return glm::normalize(along * normal + slope.x * frame.u + slope.y * frame.v);
}

OsculatingSurface storable(const OsculatingSurface& surface) {
  constexpr double kBand = 8e-4;  // more than a step of the codes
  if (std::abs(surface.normal.z) >= kBand) return surface;
  OsculatingSurface stored = surface;
  stored.normal = glm::normalize(glm::dvec3(surface.normal.x, surface.normal.y, 0));
  stored.frame = tangent_frame(stored.normal);
  const auto in_frame = [&](const glm::dvec3& e) {
    return glm::dvec2(glm::dot(e, surface.frame.u), glm::dot(e, surface.frame.v));
  };
  const glm::dvec2 u = in_frame(stored.frame.u);
  const glm::dvec2 v = in_frame(stored.frame.v);
  const Curvature& k = surface.curvature;
  stored.curvature = {glm::dot(u, k.times(u)), glm::dot(u, k.times(v)), glm::dot(v, k.times(v))};
  return stored;
}

std::optional<SurfaceHit> meet(const OsculatingSurface& surface, const glm::dvec3& ray, bool oriented) {
  const Entry entry = entry_of(surface, ray);
  if (!oriented && entry.b > 0) return meet(turned(surface), ray, true);
  const double square = entry.b * entry.b - 4 * entry.a * entry.c;
  if (!(square >= 0)) return std::nullopt;
  // The ray enters where the distance falls: 2 a t + b = -sqrt(square). Both forms are that root; each cancels where
  // the other does not.
  const double root = std::sqrt(square);
  const double after = entry.b <= 0 ? 2 * entry.c / (root - entry.b) : -(entry.b + root) / (2 * entry.a);
  const double t = entry.nearest + after;
  if (!(t > 0) || !std::isfinite(t)) return std::nullopt;
  const glm::dvec2 place = surface.place(t * ray);
  return SurfaceHit{t, place, surface.normal_at(place)};
}

CurvatureCode encode_curvature(const Curvature& curvature, double radius) {
  const auto code = [radius](double k) {
    return static_cast<int16_t>(std::lround(std::clamp(k * radius, -1.0, 1.0) * kCurvatureSteps));
  };
  return {code(curvature.uu), code(curvature.uv), code(curvature.vv), 0};
}

int16_t encode_border(const Border& border) {
  const double turn = std::atan2(border.direction.y, border.direction.x) / (2 * std::numbers::pi);
  const auto angle = static_cast<int>(std::lround(turn * 256)) & 255;
  const auto distance = static_cast<int>(std::lround(std::clamp(border.distance * kBorderSteps, 1.0, 127.0)));
  return static_cast<int16_t>(256 * distance + angle);
}

std::optional<Border> decode_border(int16_t code) {
  if (code < 256) return std::nullopt;
  const double angle = 2 * std::numbers::pi * (code & 255) / 256;
  return Border{{std::cos(angle), std::sin(angle)}, static_cast<double>(code >> 8) / kBorderSteps};
}

Curvature decode_curvature(const CurvatureCode& code, double radius) {
  const double step = 1 / (kCurvatureSteps * radius);
  return {code[0] * step, code[1] * step, code[2] * step};
}

CurvatureColumns::CurvatureColumns(const std::vector<ScalarAttribute>& scalars) {
  for (const ScalarAttribute& scalar : scalars) {
    const auto* const found = std::find(kCurvatureColumns.begin(), kCurvatureColumns.end(), scalar.name);
    if (found == kCurvatureColumns.end()) continue;
    columns_.at(static_cast<size_t>(found - kCurvatureColumns.begin())) =
        std::get_if<std::vector<int16_t>>(&scalar.values);
  }
  if (std::find(columns_.begin(), columns_.end(), nullptr) != columns_.end()) columns_ = {};
}

CurvatureCode CurvatureColumns::at(size_t i) const {
  const auto bounded = [](int16_t code) { return std::clamp<int16_t>(code, -kCurvatureSteps, kCurvatureSteps); };
  const int16_t border = (*columns_[3])[i];
  return {bounded((*columns_[0])[i]), bounded((*columns_[1])[i]), bounded((*columns_[2])[i]),
          decode_border(border) ? border : int16_t{0}};
}

bool is_curvature_column(std::string_view name) {
  return std::find(kCurvatureColumns.begin(), kCurvatureColumns.end(), name) != kCurvatureColumns.end();
}

void add_curvature(const std::vector<CurvatureCode>& codes, SurfelCloud& cloud) {
  SURFCAST_EXPECTS(codes.size() == cloud.size());
  std::vector<ScalarAttribute> columns;
  for (size_t c = 0; c < kCurvatureColumns.size(); ++c) {
    std::vector<int16_t> values(codes.size());
    std::transform(codes.begin(), codes.end(), values.begin(), [c](const CurvatureCode& code) { return code.at(c); });
    columns.push_back({std::string(kCurvatureColumns.at(c)), std::move(values)});
  }
  cloud.scalars.insert(cloud.scalars.begin(), columns.begin(), columns.end());
}

}  // namespace surfcast::surfel
