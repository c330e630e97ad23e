#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "builder/spool_file.h"
#include "gaussian/gaussians.h"
#include "geometry/morton.h"

namespace surfcast::builder {

/// Sorts Gaussians by their Morton codes, those of one code in the order in which they were added. Those that exceed
/// the memory wait in sorted runs in a temporary file beside the target. The result does not depend on the memory.
class GaussianSorter {
 public:
  /// `bytes`: memory for the Gaussians; `degree`: of their harmonics.
  GaussianSorter(std::filesystem::path target, const geometry::RootCube& root, int degree, uint64_t bytes);

  Status add(const gaussian::Gaussians& gaussians);
  /// Call after the last one, before reading.
  Status finish();

  /// The Morton code of the Gaussian `ahead` places after the next one; none beyond the last. `ahead` is at most
  /// kLookAhead.
  Result<std::optional<uint64_t>> code(size_t ahead);
  /// Takes the next `count` Gaussians; there must be as many.
  Result<gaussian::Gaussians> take(size_t count);

  static constexpr size_t kLookAhead = 16384;

 private:
  /// A sorted part of the spool, and what of it is in memory.
  struct Run {
    uint64_t next = 0;  ///< in the spool
    uint64_t end = 0;
    std::vector<std::byte> buffer;
    size_t at = 0;  ///< in the buffer
  };

  [[nodiscard]] const std::byte* record(size_t i) const { return records_.data() + i * record_bytes_; }
  void sort_records();
  Status write_run();
  Status refill(Run& run);
  Status fetch(size_t count);
  Status fetch_one();

  std::filesystem::path target_;
  geometry::RootCube root_;
  size_t width_;         ///< coefficients of a Gaussian
  size_t record_bytes_;  ///< of a Gaussian with its code and number
  uint64_t bytes_;
  uint64_t added_ = 0;
  std::vector<std::byte> records_;  ///< while adding, those of the next run; then those that were looked at
  size_t taken_ = 0;                ///< of records_
  std::optional<SpoolFile> spool_;
  std::vector<Run> runs_;
};

}  // namespace surfcast::builder
