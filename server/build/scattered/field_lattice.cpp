#include "scattered/field_lattice.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <vector>

#include "geometry/box.h"
#include "model/volume.h"

namespace surfcast::scattered {
namespace {

/// Kernels that are widened to lattices of different steps.
class Extents {
 public:
  explicit Extents(const Samples& samples) : samples_(samples) {
    deviations_.reserve(samples.kernels.size());
    for (const KernelSample& sample : samples.kernels) deviations_.push_back(least_deviation(sample, samples.profile));
  }

  /// The box around all kernels, widened to a deviation.
  [[nodiscard]] geometry::Box box(double deviation) const {
    geometry::Box box;
    for (size_t i = 0; i < deviations_.size(); ++i) {
      KernelSample sample = samples_.kernels[i];
      if (deviations_[i] < deviation) widen(deviation, samples_.profile, false, sample);
      const glm::dvec3 half = sample.half_extent(samples_.profile);
      box.include(sample.centre - half);
      box.include(sample.centre + half);
    }
    return box;
  }

  /// The deviation that all but a few kernels have at least.
  [[nodiscard]] double fine_deviation() const {
    std::vector<double> sorted = deviations_;
    const auto rank = static_cast<std::ptrdiff_t>(kFinerShare * static_cast<double>(sorted.size()));
    std::ranges::nth_element(sorted, sorted.begin() + rank);
    return sorted[static_cast<size_t>(rank)];
  }

 private:
  const Samples& samples_;
  std::vector<double> deviations_;
};

double longest_side(const geometry::Box& box) {
  const glm::dvec3 size = box.size();
  return std::max({size.x, size.y, size.z});
}

/// Samples along the axes. A box that is a whole number of steps but for rounding takes no further one.
glm::dvec3 axis_samples(const geometry::Box& box, double step) {
  return glm::ceil(box.size() / step * (1 - 1e-9)) + 1.0;
}

double samples_of(const geometry::Box& box, double step) {
  const glm::dvec3 count = axis_samples(box, step);
  return count.x * count.y * count.z;
}

/// The finest step of at least `step` that leaves at most so many samples.
double limited_step(const Extents& extents, double step, double most) {
  double samples = samples_of(extents.box(step), step);
  while (samples > most) {
    step *= std::max(std::cbrt(samples / most), 1.001);
    samples = samples_of(extents.box(step), step);
  }
  return step;
}

/// The step with so many samples along the longest axis. Wider kernels take a larger box, so it is found by iteration.
double step_for(const Extents& extents, uint32_t resolution) {
  constexpr int kIterations = 30;
  const double steps = std::max(resolution, kMinResolution) - 1.0;
  double step = longest_side(extents.box(0)) / steps;
  for (int i = 0; i < kIterations; ++i) {
    const double next = longest_side(extents.box(step)) / steps;
    if (next <= step) break;
    step = next;
  }
  return step;
}

Status check_places(const geometry::Box& box) {
  constexpr double kFarthest = 1e100;
  constexpr double kPrecision = 1e-14;
  const glm::dvec3 away = glm::max(glm::abs(box.min), glm::abs(box.max));
  const double farthest = std::max({away.x, away.y, away.z});
  if (farthest < kFarthest && longest_side(box) > kPrecision * farthest) return {};
  return fail(ErrorKind::kInvalidInput, "the samples lie too far from the origin for the size of their kernels");
}

}  // namespace

Result<FieldLattice> plan_lattice(const Samples& samples, Combination combination, std::optional<uint32_t> resolution,
                                  uint64_t most_samples) {
  const Extents extents(samples);
  const geometry::Box unwidened = extents.box(0);
  if (Status status = check_places(unwidened); !status) return fail(status);
  FieldLattice lattice;
  if (resolution) {
    lattice.step = step_for(extents, *resolution);
  } else {
    const double needed = extents.fine_deviation() / steps_per_deviation(combination);
    const double finest = std::max(needed, longest_side(unwidened) / double{model::kMaxAxisSamples});
    lattice.step = limited_step(extents, finest, static_cast<double>(most_samples));
  }
  const geometry::Box box = extents.box(lattice.step);
  lattice.origin = box.min;
  lattice.size = glm::u32vec3(axis_samples(box, lattice.step));
  return lattice;
}

uint64_t widen_to_lattice(const FieldLattice& lattice, bool keeps_integral, Samples& samples) {
  uint64_t widened = 0;
  for (KernelSample& sample : samples.kernels) {
    if (widen(lattice.step, samples.profile, keeps_integral, sample)) ++widened;
  }
  return widened;
}

}  // namespace surfcast::scattered
