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

namespace surfcast::exporter {

/// Records of one size in the order in which they came. Those that exceed the memory wait in a temporary file beside
/// the target.
class RecordSpool {
 public:
  /// `memory`: bytes for records.
  RecordSpool(std::filesystem::path target, size_t record_bytes, uint64_t memory);

  Status append(std::span<const std::byte> records);
  [[nodiscard]] uint64_t bytes() const { return (file_ ? file_->size() : 0) + waiting_.size(); }
  /// Whether everything is in memory.
  [[nodiscard]] bool is_resident() const { return !file_; }
  /// All records, if they are in memory.
  [[nodiscard]] std::vector<std::byte> take_resident() { return std::move(waiting_); }
  /// Calls `use` with all records, in batches. `release`: their disk space is freed as they are read.
  Status for_each_batch(bool release, const std::function<Status(std::span<const std::byte>)>& use);

 private:
  Status write_waiting();

  std::filesystem::path target_;
  size_t record_bytes_;
  uint64_t memory_;
  std::vector<std::byte> waiting_;
  std::optional<SpoolFile> file_;
};

}  // namespace surfcast::exporter
