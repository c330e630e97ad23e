#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/atomic_file.h"
#include "base/result.h"
#include "exporter/las_counts.h"
#include "exporter/record_writer.h"

namespace surfcast::exporter {

/// Writes a LAS or LAZ file of point records, in their order.
class LasFileWriter : public RecordWriter {
 public:
  static Result<LasFileWriter> create(const std::filesystem::path& target, LasHead head);

  /// Appends records of `record_length` bytes. LAZ keeps those of chunks that are not full.
  Status append(std::span<const std::byte> records) override;
  [[nodiscard]] uint64_t points() const override { return counts_.points; }
  Result<uint64_t> finish() override;

 private:
  struct Chunk {
    size_t points = 0;
    size_t bytes = 0;
  };

  LasFileWriter(AtomicFile file, std::filesystem::path target, LasHead head);
  Status write_head();
  Status append_chunks(std::span<const std::byte> records);
  Status write_chunk_table();
  Status write_extended();

  AtomicFile file_;
  std::filesystem::path target_;
  LasHead head_;
  size_t data_offset_ = 0;
  std::vector<std::byte> waiting_;  ///< records that do not fill a chunk yet
  std::vector<Chunk> chunks_;
  LasCounts counts_;
};

}  // namespace surfcast::exporter
