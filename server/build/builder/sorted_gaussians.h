#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/result.h"
#include "builder/sorted_records.h"
#include "gaussian/gaussians.h"
#include "geometry/morton.h"

namespace surfcast::builder {

/// Sorts Gaussians by their Morton codes, those of one code in the order in which they were added (SortedRecords).
class GaussianSorter {
 public:
  /// `bytes`: memory for the Gaussians; `degree`: of their harmonics.
  GaussianSorter(std::filesystem::path target, const geometry::RootCube& root, int degree, uint64_t bytes);

  Status add(const gaussian::Gaussians& gaussians);
  /// Call after the last one, before reading.
  Status finish() { return records_.finish(); }

  /// The Morton code of the Gaussian `ahead` places after the next one; none beyond the last. `ahead` is at most
  /// SortedRecords::kLookAhead.
  Result<std::optional<uint64_t>> code(size_t ahead) { return records_.code(ahead); }
  /// Takes the next `count` Gaussians; there must be as many.
  Result<gaussian::Gaussians> take(size_t count);

 private:
  geometry::RootCube root_;
  size_t width_;  ///< coefficients of a Gaussian
  std::vector<std::byte> record_;
  SortedRecords records_;
};

}  // namespace surfcast::builder
