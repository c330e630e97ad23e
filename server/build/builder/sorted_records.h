#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "base/spool_file.h"

namespace surfcast::builder {

/// Of the memory budget, for the records that are sorted. Sorting copies them, and blocks are made of others.
inline constexpr uint64_t kSortingShare = 4;

/// Sorts records of one size by their codes, those of one code in the order in which they were added. Those that exceed
/// the memory wait in sorted runs in a temporary file beside the target. The result does not depend on the memory.
class SortedRecords {
 public:
  /// `record_bytes`: of a record; `memory`: for records, bytes.
  SortedRecords(std::filesystem::path target, size_t record_bytes, uint64_t memory);

  Status add(uint64_t code, std::span<const std::byte> record);
  /// Call after the last one, before reading.
  Status finish();

  /// The code of the record `ahead` places after the next one; none beyond the last. `ahead` is at most kLookAhead.
  Result<std::optional<uint64_t>> code(size_t ahead);
  /// Takes the next `count` records; there must be as many. The bytes of a record are valid during the call.
  Status take(size_t count, const std::function<void(std::span<const std::byte>)>& use);

  static constexpr size_t kLookAhead = 16384;

 private:
  /// A sorted part of the spool, and what of it is in memory.
  struct Run {
    uint64_t next = 0;  ///< in the spool
    uint64_t end = 0;
    std::vector<std::byte> buffer;
    size_t at = 0;  ///< in the buffer
  };

  [[nodiscard]] const std::byte* stored(size_t i) const { return records_.data() + i * stored_bytes_; }
  void sort_records();
  Status write_run();
  Status refill(Run& run);
  Status fetch(size_t count);
  Status fetch_one();

  std::filesystem::path target_;
  size_t record_bytes_;
  size_t stored_bytes_;  ///< of a record with its code and number
  uint64_t memory_;
  uint64_t added_ = 0;
  std::vector<std::byte> records_;  ///< while adding, those of the next run; then those that were looked at
  size_t taken_ = 0;                ///< of records_
  std::optional<SpoolFile> spool_;
  std::vector<Run> runs_;
};

}  // namespace surfcast::builder
