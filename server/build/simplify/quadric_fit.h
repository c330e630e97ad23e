#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "surfel/curvature.h"

namespace surfcast::simplify {

/// A point of a surface with its unit normal.
struct Sample {
  glm::dvec3 position{0};
  glm::dvec3 normal{0, 0, 1};
};

/// The least samples that determine a surface: there are six unknowns and three equations a sample, with noise.
inline constexpr size_t kMinSamples = 6;

/// Fits an osculating surface to samples by least squares: the heights and the slopes of the normals in one problem, in
/// units of the neighbourhood's radius, slopes weighted by 1/4. Heights alone need twice as many samples against noise,
/// and normals alone do not see where the surface lies.
class QuadricFit {
 public:
  /// The surface is sought about `centre`, whose normal is about `normal` (unit). `unit`: the neighbourhood's radius.
  QuadricFit(const glm::dvec3& centre, const glm::dvec3& normal, double unit);

  /// Normals of samples on surfaces without a front and a back may be on either side.
  void add(const Sample& sample, bool oriented);
  [[nodiscard]] size_t samples() const { return samples_; }
  /// The surface over `centre`. None if the samples do not determine it.
  [[nodiscard]] std::optional<surfel::OsculatingSurface> solve() const;

 private:
  static constexpr int kUnknowns = 6;

  void add_equation(const std::array<double, kUnknowns>& row, double value, double weight);

  glm::dvec3 centre_;
  glm::dvec3 normal_;
  surfel::TangentFrame frame_;
  double unit_;
  size_t samples_ = 0;
  std::array<double, kUnknowns * kUnknowns> matrix_{};
  std::array<double, kUnknowns> right_{};
};

/// The surface that fits the samples around `centre`: their mean normal is the first guess.
std::optional<surfel::OsculatingSurface> fit_surface(const glm::dvec3& centre, std::span<const Sample> samples,
                                                     bool oriented);

/// How far samples are from a surface.
struct Residual {
  double angle = 0;        ///< 90th percentile of the angles between normals, radians
  double height = 0;       ///< largest distance along the normal, world units
  double mean_angle = 0;   ///< root of the mean square
  double mean_height = 0;  ///< likewise
};

Residual residual_of(const surfel::OsculatingSurface& surface, std::span<const Sample> samples, bool oriented);

/// The mean plane of the samples about a fit.
surfel::OsculatingSurface plane_of(const surfel::OsculatingSurface& fit, std::span<const Sample> samples,
                                   bool oriented);

/// True if curvature lowers the residual of samples within `reach` by 15 % against their plane. With fewer than
/// kMinSamplesPerPoint for each surfel six numbers fit the noise, and the averages are better, whatever this says.
bool gains(const Residual& curved, const Residual& flat, double reach);
inline constexpr double kMinSamplesPerPoint = 20;

}  // namespace surfcast::simplify
