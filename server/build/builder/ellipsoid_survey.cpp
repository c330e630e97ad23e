#include "builder/ellipsoid_survey.h"

#include <algorithm>
#include <cmath>

#include "ellipsoid/tensor.h"

namespace surfcast::builder {
namespace {

constexpr double kAnisotropic = 0.2;
constexpr double kHighShare = 0.95;
constexpr int kMagnitudeSteps = 512;  // an octave: the percentile is within 0.07 %

}  // namespace

void EllipsoidSurvey::Range::include(double value) {
  if (!std::isfinite(value)) return;
  least = std::min(least, value);
  most = std::max(most, value);
}

void EllipsoidSurvey::include(size_t attribute, double value) {
  if (ranges_.size() <= attribute) ranges_.resize(attribute + 1);
  ranges_[attribute].include(value);
}

void EllipsoidSurvey::add(const ellipsoid::Ellipsoids& run) {
  for (size_t i = 0; i < run.size(); ++i) {
    const glm::dvec3& values = run.values[i];
    const double fa = ellipsoid::fractional_anisotropy(values);
    const double mode = ellipsoid::mode_of(values);
    bounds_.include(run.positions[i]);
    anisotropy_ += fa;
    mode_ += mode;
    values_ += values;
    anisotropic_ += fa >= kAnisotropic ? 1 : 0;
    largest_ = std::max(largest_, values.x);
    ++magnitudes_[static_cast<int>(std::floor(std::log2(values.x) * kMagnitudeSteps))];
    include(0, fa);
    include(1, mode);
    include(2, ellipsoid::mean_value(values));
  }
  for (size_t s = 0; s < run.scalars.size(); ++s) {
    std::visit(
        [&](const auto& typed) {
          for (const auto value : typed) include(model::kDerivedAttributes + s, static_cast<double>(value));
        },
        run.scalars[s].values);
  }
  drawn_ += run.size();
}

/// The percentile of the largest values.
double EllipsoidSurvey::high_value() const {
  const double wanted = kHighShare * static_cast<double>(drawn_);
  uint64_t below = 0;
  for (const auto& [magnitude, count] : magnitudes_) {
    below += count;
    if (static_cast<double>(below) >= wanted) return std::min(largest_, std::exp2((magnitude + 0.5) / kMagnitudeSteps));
  }
  return largest_;
}

/// Of a source without a grid that of as many samples in a cube.
double EllipsoidSurvey::spacing_of(const model::EllipsoidSource& source) const {
  if (source.on_grid()) return source.least_step();
  const glm::dvec3 size = bounds_.max - bounds_.min;
  const double longest = std::max({size.x, size.y, size.z});
  const double spacing = longest / std::max(1.0, std::cbrt(static_cast<double>(source.counts.samples)) - 1);
  return spacing > 0 ? spacing : 1;
}

void EllipsoidSurvey::complete(model::EllipsoidSource& source) const {
  const auto count = static_cast<double>(drawn_);
  source.counts.anisotropic = anisotropic_;
  source.mean_anisotropy = anisotropy_ / count;
  source.mean_mode = mode_ / count;
  source.mean_values = values_ / count;
  source.largest = largest_;
  source.high = high_value();
  source.reach = source.tensors ? spacing_of(source) / 2 : source.high;
  for (size_t i = 0; i < source.attributes.size() && i < ranges_.size(); ++i) {
    if (ranges_[i].least > ranges_[i].most) continue;
    source.attributes[i].smallest = ranges_[i].least;
    source.attributes[i].largest = ranges_[i].most;
  }
}

}  // namespace surfcast::builder
