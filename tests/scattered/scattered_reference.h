#pragma once

#include <filesystem>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <string>
#include <vector>

namespace surfcast::testing {

/// A sample of a field, as a user states it.
struct StatedSample {
  glm::dvec3 place{0};
  double value = 0;
  double size = 0;           ///< smoothing length, or deviation of a Gaussian
  glm::dmat3 covariance{1};  ///< of a Gaussian with axes of its own
};

enum class StatedKernel { kSpline, kGaussian, kCovariance };
enum class StatedField { kSum, kAverage, kDensity };

/// The field of samples in double precision, by the formulas of docs/volumes.md, without the code of the server.
/// `outside` and `least_weight` are those of averages.
double reference_field(const std::vector<StatedSample>& samples, StatedKernel kernel, StatedField field,
                       const glm::dvec3& place, double outside = 0, double least_weight = 0.1);

/// Samples within [-extent, extent]^3 with values from 0.2 to 1 and sizes from `least` to `most`, evenly on a
/// logarithmic scale. Covariances have axes in all directions and are up to three times as long as wide.
std::vector<StatedSample> random_samples(size_t count, double extent, double least, double most, uint32_t seed);

/// Writes a table with columns x, y, z, v, the size as `size_name`, and the covariances as cov_xx to cov_zz.
std::filesystem::path write_samples(const std::filesystem::path& path, const std::vector<StatedSample>& samples,
                                    const std::string& size_name);

}  // namespace surfcast::testing
