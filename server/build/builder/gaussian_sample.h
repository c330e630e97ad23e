#pragma once

#include <cstdint>
#include <optional>

#include "gaussian/gaussians.h"

namespace surfcast::builder {

/// Chooses the Gaussians of a preview from the successive runs of all inputs: of every k the one that a hash chooses.
/// Those that are chosen are widened by sqrt(k), so that they cover as much area as all. Inputs are Gaussians that are
/// usable; where some are not, the last groups are missing.
class GaussianSample {
 public:
  /// `count`: Gaussians of all inputs; `wanted`: of the sample; none: all stay as they are.
  GaussianSample(uint64_t count, std::optional<uint64_t> wanted);

  /// Leaves the chosen Gaussians of the next run.
  void thin(gaussian::Gaussians& run);

 private:
  [[nodiscard]] uint64_t first_of(uint64_t group) const { return group * count_ / wanted_; }
  [[nodiscard]] uint64_t chosen_of(uint64_t group) const;

  uint64_t count_;
  uint64_t wanted_;
  uint64_t passed_ = 0;  ///< Gaussians of earlier runs
  uint64_t group_ = 0;   ///< of successive Gaussians, of which one is chosen
};

}  // namespace surfcast::builder
