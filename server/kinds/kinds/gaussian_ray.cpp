#include "kinds/gaussian_ray.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "shared/gaussian_layout.h"

namespace surfcast::kinds {
namespace {

double square(const glm::dvec3& v) {
  return glm::dot(v, v);
}

/// det(M) M^-1, of singular matrices too: its rows are the cross products of the columns of M.
glm::dmat3 adjugate(const glm::dmat3& m) {
  return glm::transpose(glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])));
}

int pixel_at(double position) {
  return static_cast<int>(std::floor(std::clamp(position, -1e6, 1e6)));
}

}  // namespace

GaussianOnRays::GaussianOnRays(const glm::dvec3& centre, const glm::dmat3& factor, double opacity, double eta)
    : o_(centre),
      transposed_(glm::transpose(factor)),
      adjugate_(adjugate(factor)),
      opacity_(std::min(opacity, SURFCAST_TRAINED_MOST)),
      cutoff_(opacity > SURFCAST_TRAINED_LEAST ? 2 * std::log(opacity / SURFCAST_TRAINED_LEAST) : 0),
      variance_(SURFCAST_TRAINED_DILATION * centre.z * centre.z / (eta * eta)) {}

// The secant form of docs/kernel.md. With B = A V A^T, where the rows of A are (1, 0, -d.x) and (0, 1, -d.y), the
// screen's covariance is B + p I in units of (eta / o.z)^2, and for 2 x 2 matrices adj(B + p I) = adj(B) + p I.
std::optional<GaussianOnRays::Seen> GaussianOnRays::on_ray(const glm::dvec3& ray) const {
  const double p = variance_;
  const glm::dvec3 a1 = transposed_ * glm::dvec3(1, 0, -ray.x);
  const glm::dvec3 a2 = transposed_ * glm::dvec3(0, 1, -ray.y);
  const glm::dvec2 w{o_.z * ray.x - o_.x, o_.z * ray.y - o_.y};
  const double trace = square(a1) + square(a2);
  const glm::dvec3 ad = adjugate_ * ray;
  const double det = square(ad) + p * trace + p * p;
  if (!(det > 0)) return std::nullopt;
  const double r2 = (square(transposed_ * glm::cross(ray, o_)) + p * glm::dot(w, w)) / det;
  const double shift = glm::dot(a1, transposed_[2]) * w.x + glm::dot(a2, transposed_[2]) * w.y;
  const double depth = (glm::dot(ad, adjugate_ * o_) + p * (o_.z * trace + shift) + p * p * o_.z) / det;
  if (!(r2 < cutoff_) || !(depth > 0)) return std::nullopt;
  return Seen{r2, depth, opacity_ * std::exp(-0.5 * r2)};
}

// r2 <= c requires v_x^2 <= c S_xx at the pixel: a quadratic in ray.x, and the same for y.
PixelRange GaussianOnRays::pixels(const geometry::CameraFrame& frame, const PixelRange& within) const {
  const glm::dvec3& a3 = transposed_[2];
  const double a = o_.z * o_.z - cutoff_ * square(a3);
  if (!(a > 0)) return within;
  glm::dvec2 low{0};
  glm::dvec2 high{0};
  for (int i = 0; i < 2; ++i) {
    const double half_b = o_[i] * o_.z - cutoff_ * glm::dot(transposed_[i], a3);
    const double c = o_[i] * o_[i] - cutoff_ * (square(transposed_[i]) + variance_);
    const double root = std::sqrt(std::max(0.0, half_b * half_b - a * c));
    low[i] = (half_b - root) / a;
    high[i] = (half_b + root) / a;
  }
  const glm::dvec2 first = frame.project({low.x, high.y, 1});
  const glm::dvec2 last = frame.project({high.x, low.y, 1});
  return {glm::max(within.first, glm::ivec2(pixel_at(first.x - 0.5), pixel_at(first.y - 0.5))),
          glm::min(within.last, glm::ivec2(pixel_at(last.x + 0.5), pixel_at(last.y + 0.5)))};
}

}  // namespace surfcast::kinds
