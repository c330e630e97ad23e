#include "scattered/scattered_reference.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <iomanip>
#include <numbers>

namespace surfcast::testing {
namespace {

/// Monaghan and Lattanzio (1985), with 1 at the centre.
double spline(double q) {
  if (q < 1) return 1 - 1.5 * q * q + 0.75 * q * q * q;
  return q < 2 ? 0.25 * std::pow(2 - q, 3) : 0;
}

double kernel_at(const StatedSample& sample, StatedKernel kernel, const glm::dvec3& d) {
  if (kernel == StatedKernel::kSpline) return spline(glm::length(d) / sample.size);
  if (kernel == StatedKernel::kGaussian) return std::exp(-0.5 * glm::dot(d, d) / (sample.size * sample.size));
  return std::exp(-0.5 * glm::dot(d, glm::inverse(sample.covariance) * d));
}

double integral(const StatedSample& sample, StatedKernel kernel) {
  const double cube = std::pow(sample.size, 3);
  if (kernel == StatedKernel::kSpline) return std::numbers::pi * cube;
  const double determinant = kernel == StatedKernel::kGaussian ? cube : std::sqrt(glm::determinant(sample.covariance));
  return std::pow(2 * std::numbers::pi, 1.5) * determinant;
}

}  // namespace

double reference_field(const std::vector<StatedSample>& samples, StatedKernel kernel, StatedField field,
                       const glm::dvec3& place, double outside, double least_weight) {
  double sum = 0;
  double weight = 0;
  for (const StatedSample& sample : samples) {
    double w = kernel_at(sample, kernel, place - sample.place);
    if (field == StatedField::kDensity) w /= integral(sample, kernel);
    sum += w * sample.value;
    weight += w;
  }
  if (field != StatedField::kAverage) return sum;
  return (sum + outside * std::max(0.0, least_weight - weight)) / std::max(weight, least_weight);
}

std::vector<StatedSample> random_samples(size_t count, double extent, double least, double most, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto side = [&] { return 2 * unit(random) - 1; };
  std::vector<StatedSample> samples;
  for (size_t i = 0; i < count; ++i) {
    StatedSample sample;
    sample.place = extent * glm::dvec3(side(), side(), side());
    sample.value = 0.2 + 0.8 * unit(random);
    sample.size = least * std::pow(most / least, unit(random));
    const glm::dmat3 axes = glm::mat3_cast(glm::normalize(glm::dquat(side(), side(), side(), side())));
    glm::dmat3 diagonal(0);
    for (int axis = 0; axis < 3; ++axis) diagonal[axis][axis] = std::pow(sample.size * (1 + 2 * unit(random)), 2);
    sample.covariance = axes * diagonal * glm::transpose(axes);
    samples.push_back(sample);
  }
  return samples;
}

std::filesystem::path write_samples(const std::filesystem::path& path, const std::vector<StatedSample>& samples,
                                    const std::string& size_name) {
  std::ofstream out(path);
  out << std::setprecision(17) << "x,y,z,v," << size_name << ",cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz\n";
  for (const StatedSample& s : samples) {
    out << s.place.x << ',' << s.place.y << ',' << s.place.z << ',' << s.value << ',' << s.size;
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) out << ',' << s.covariance[column][row];
    }
    out << '\n';
  }
  return path;
}

}  // namespace surfcast::testing
