#pragma once

#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "reference/volume_field.h"

namespace surfcast::reference {

/// Samples of a scalar at origin + axes * (i, j, k), world coordinates. Axes may be of any length and not
/// perpendicular.
struct VolumeGrid {
  glm::ivec3 size{0};
  glm::dvec3 origin{0};
  glm::dmat3 axes{1};          ///< columns: the steps from sample to sample, world units
  std::vector<double> values;  ///< i fastest
  glm::dvec3 low{0};           ///< faces of the volume in units of (i, j, k): the first and last samples of the
  glm::dvec3 high{0};          ///< finest level; half a sample beyond along an axis of one sample

  /// The sample, or that at the face beyond which it lies.
  [[nodiscard]] double at(const glm::ivec3& i) const;
  [[nodiscard]] glm::dvec3 place(const glm::dvec3& index) const { return origin + axes * index; }
  [[nodiscard]] glm::dvec3 centre() const { return place(0.5 * (low + high)); }
  /// Distance of the samples along a unit direction: where a ray leaves the ellipsoid of one spacing.
  [[nodiscard]] double spacing_along(const glm::dvec3& direction) const;
};

/// A grid with the given samples and places; its faces are the first and last samples.
VolumeGrid make_grid(const glm::ivec3& size, const glm::dvec3& origin, const glm::dmat3& axes,
                     const std::function<double(const glm::dvec3& place)>& value);
/// Samples of a field over [-1, 1]^3, faces included.
VolumeGrid sampled(const VolumeField& field, const glm::ivec3& size);

/// The coarser level: means of 2 x 2 x 2 samples, at the mean of their places, with the faces of the finer level.
VolumeGrid halved(const VolumeGrid& grid);

/// Weight of the sample at distance `m` in the sum of Gaussians of standard deviation sigma (spacings), at a sample.
/// Sum 1 over all m.
double tap(int m, double sigma);
/// Samples for kernels that reproduce the grid's samples: `times` times c += sample - taps * c, the border repeated.
VolumeGrid corrected(const VolumeGrid& grid, double sigma, int times);
/// Central differences of the samples in world axes, for every sample.
std::vector<glm::dvec3> sample_gradients(const VolumeGrid& grid);

/// Values between samples; `index` in units of (i, j, k).
double trilinear(const VolumeGrid& grid, const glm::dvec3& index);
double catmull_rom(const VolumeGrid& grid, const glm::dvec3& index);
/// Sum of Gaussians with their three-dimensional cutoff, normalised for their cutoff along a ray.
double gaussian_sum(const VolumeGrid& coefficients, double sigma, const glm::dvec3& index);

}  // namespace surfcast::reference
