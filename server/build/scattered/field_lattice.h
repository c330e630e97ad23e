#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "base/result.h"
#include "scattered/kernel_sample.h"
#include "scattered/read_samples.h"

namespace surfcast::scattered {

/// A regular lattice over all kernels.
struct FieldLattice {
  glm::dvec3 origin{0};  ///< the place of sample (0, 0, 0), world
  double step = 1;       ///< between neighbouring samples, the same along all axes, world units
  glm::u32vec3 size{1};

  [[nodiscard]] uint64_t samples() const { return uint64_t{size.x} * size.y * size.z; }
};

/// The most samples of a lattice whose resolution is not stated.
inline constexpr uint64_t kMaxLatticeSamples = uint64_t{1} << 27;
/// Steps of the lattice to the deviation of a kernel: cubic interpolation of a Gaussian is then off by 0.2 % of its
/// peak at most. An average of few samples has narrower features than their kernels.
[[nodiscard]] constexpr double steps_per_deviation(Combination combination) {
  return combination == Combination::kAverage ? 2.5 : 2;
}
/// The share of kernels that may be finer than that: a few tiny ones do not decide for all.
inline constexpr double kFinerShare = 0.02;

/// The least resolution: kernels as wide as a step would reach beyond coarser ones.
inline constexpr uint32_t kMinResolution = 16;

/// A lattice for these kernels: as fine as they need, with at most `most_samples`, or with `resolution` samples along
/// its longest axis. It has room for kernels widened to its step. Fails if a place is too far away.
Result<FieldLattice> plan_lattice(const Samples& samples, Combination combination, std::optional<uint32_t> resolution,
                                  uint64_t most_samples);

/// Widens the kernels that the lattice does not resolve to a deviation of one step. Returns how many.
uint64_t widen_to_lattice(const FieldLattice& lattice, bool keeps_integral, Samples& samples);

}  // namespace surfcast::scattered
