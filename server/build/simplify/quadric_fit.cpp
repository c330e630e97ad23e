#include "simplify/quadric_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "base/contract.h"

namespace surfcast::simplify {
namespace {

constexpr double kSlopeWeight = 0.25;

glm::dvec3 turned(const glm::dvec3& n, const glm::dvec3& like, bool oriented) {
  return !oriented && glm::dot(n, like) < 0 ? -n : n;
}

glm::dvec3 mean_normal(std::span<const Sample> samples, bool oriented) {
  glm::dvec3 sum(0);
  for (const Sample& s : samples) sum += turned(s.normal, samples.front().normal, oriented);
  const double length = glm::length(sum);
  return length > 0 ? sum / length : samples.front().normal;
}

/// Polynomial of the height over a frame: h + g . q + q . hessian q / 2, world units.
struct Polynomial {
  double h = 0;
  glm::dvec2 g{0};
  surfel::Curvature hessian;
};

/// The osculating surface of the graph at the origin of the frame (do Carmo, section 3-3): the tangent vectors of the
/// graph are (p, g . p), its second fundamental form is that of the hessian over the length of (-g, 1).
surfel::OsculatingSurface surface_at_origin(const Polynomial& graph, const glm::dvec3& centre, const glm::dvec3& normal,
                                            const surfel::TangentFrame& frame) {
  surfel::OsculatingSurface surface;
  surface.centre = centre + graph.h * normal;
  const double length = std::sqrt(1 + glm::dot(graph.g, graph.g));
  surface.normal = (normal - graph.g.x * frame.u - graph.g.y * frame.v) / length;
  surface.frame = surfel::tangent_frame(surface.normal);
  const auto flat = [&frame](const glm::dvec3& e) { return glm::dvec2(glm::dot(e, frame.u), glm::dot(e, frame.v)); };
  const glm::dvec2 u = flat(surface.frame.u);
  const glm::dvec2 v = flat(surface.frame.v);
  surface.curvature = {-glm::dot(u, graph.hessian.times(u)) / length, -glm::dot(u, graph.hessian.times(v)) / length,
                       -glm::dot(v, graph.hessian.times(v)) / length};
  return surface;
}

/// Root mean squares of both parts of a residual in units of the neighbourhood, slopes weighted as in the fit.
double cost_of(const Residual& r, double reach) {
  return std::hypot(r.mean_height / reach, 0.5 * r.mean_angle);
}

}  // namespace

QuadricFit::QuadricFit(const glm::dvec3& centre, const glm::dvec3& normal, double unit)
    : centre_(centre), normal_(normal), frame_(surfel::tangent_frame(normal)), unit_(unit) {
  SURFCAST_EXPECTS(unit > 0);
}

void QuadricFit::add_equation(const std::array<double, kUnknowns>& row, double value, double weight) {
  for (size_t i = 0; i < kUnknowns; ++i) {
    for (size_t j = 0; j <= i; ++j) matrix_[i * kUnknowns + j] += weight * row[i] * row[j];
    right_[i] += weight * row[i] * value;
  }
}

void QuadricFit::add(const Sample& sample, bool oriented) {
  const glm::dvec3 p = (sample.position - centre_) / unit_;
  const glm::dvec3 n = turned(sample.normal, normal_, oriented);
  const double u = glm::dot(p, frame_.u);
  const double v = glm::dot(p, frame_.v);
  add_equation({1, u, v, 0.5 * u * u, u * v, 0.5 * v * v}, glm::dot(p, normal_), 1);
  // Where the surface is drawn, the parts of its normal in the tangent plane are linear (OsculatingSurface::normal_at).
  add_equation({0, 1, 0, u, v, 0}, -glm::dot(n, frame_.u), kSlopeWeight);
  add_equation({0, 0, 1, 0, u, v}, -glm::dot(n, frame_.v), kSlopeWeight);
  ++samples_;
}

std::optional<surfel::OsculatingSurface> QuadricFit::solve() const {
  if (samples_ < kMinSamples) return std::nullopt;
  using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns, Eigen::RowMajor>;
  const Eigen::LDLT<Matrix, Eigen::Lower> factors(Eigen::Map<const Matrix>(matrix_.data()));
  const Eigen::Matrix<double, kUnknowns, 1> x =
      factors.solve(Eigen::Map<const Eigen::Matrix<double, kUnknowns, 1>>(right_.data()));
  const double least = factors.vectorD().minCoeff();
  if (factors.info() != Eigen::Success || !x.allFinite() || !(least > 1e-9 * factors.vectorD().maxCoeff())) {
    return std::nullopt;
  }
  return surface_at_origin({x[0] * unit_, {x[1], x[2]}, {x[3] / unit_, x[4] / unit_, x[5] / unit_}}, centre_, normal_,
                           frame_);
}

std::optional<surfel::OsculatingSurface> fit_surface(const glm::dvec3& centre, std::span<const Sample> samples,
                                                     bool oriented) {
  if (samples.empty()) return std::nullopt;
  double unit = 0;
  for (const Sample& s : samples) unit = std::max(unit, glm::distance(s.position, centre));
  if (!(unit > 0)) return std::nullopt;
  QuadricFit fit(centre, mean_normal(samples, oriented), unit);
  for (const Sample& s : samples) fit.add(s, oriented);
  return fit.solve();
}

Residual residual_of(const surfel::OsculatingSurface& surface, std::span<const Sample> samples, bool oriented) {
  SURFCAST_EXPECTS(!samples.empty());
  Residual residual;
  std::vector<double> angles;
  angles.reserve(samples.size());
  for (const Sample& s : samples) {
    const glm::dvec3 n = surface.normal_at(surface.place(s.position));
    // From the cross product: the angle of nearly equal vectors is not lost to rounding.
    const glm::dvec3 own = turned(s.normal, n, oriented);
    angles.push_back(std::atan2(glm::length(glm::cross(own, n)), glm::dot(own, n)));
    const double height = std::abs(surface.height(s.position));
    residual.height = std::max(residual.height, height);
    residual.mean_angle += angles.back() * angles.back();
    residual.mean_height += height * height;
  }
  const auto count = static_cast<double>(samples.size());
  residual.mean_angle = std::sqrt(residual.mean_angle / count);
  residual.mean_height = std::sqrt(residual.mean_height / count);
  const auto ninth = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() * 9 / 10);
  std::nth_element(angles.begin(), ninth, angles.end());
  residual.angle = *ninth;
  return residual;
}

surfel::OsculatingSurface plane_of(const surfel::OsculatingSurface& fit, std::span<const Sample> samples,
                                   bool oriented) {
  surfel::OsculatingSurface plane = fit;
  plane.curvature = {};
  double height = 0;
  glm::dvec3 normal(0);
  for (const Sample& s : samples) {
    height += glm::dot(fit.normal, s.position - fit.centre);
    normal += !oriented && glm::dot(s.normal, fit.normal) < 0 ? -s.normal : s.normal;
  }
  plane.centre += fit.normal * (height / static_cast<double>(samples.size()));
  if (glm::length(normal) > 0) plane.normal = glm::normalize(normal);
  plane.frame = surfel::tangent_frame(plane.normal);
  return plane;
}

bool gains(const Residual& curved, const Residual& flat, double reach) {
  constexpr double kGain = 0.15;
  return cost_of(curved, reach) <= (1 - kGain) * cost_of(flat, reach);
}

}  // namespace surfcast::simplify
