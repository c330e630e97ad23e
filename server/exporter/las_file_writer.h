#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/result.h"

namespace surfcast::exporter {

/// What a LAS file says before its points (LAS 1.4, tables 3 and 6).
struct LasHead {
  std::vector<std::byte> header;                 ///< figures that follow from the points are filled in later
  std::vector<std::vector<std::byte>> records;   ///< variable length records, head and body
  std::vector<std::vector<std::byte>> extended;  ///< extended ones, behind the points
  int point_format = 0;                          ///< 0 to 3 and 6 to 8
  size_t record_length = 0;                      ///< bytes
  bool compressed = false;                       ///< LAZ
  uint32_t chunk_size = 50000;                   ///< points of a chunk of LAZ
};

/// Writes a LAS or LAZ file of point records. The file appears under its name when `finish` has succeeded.
class LasFileWriter {
 public:
  static Result<LasFileWriter> create(const std::filesystem::path& target, LasHead head);

  /// Appends records of `record_length` bytes. LAZ keeps those of chunks that are not full.
  Status append(std::span<const std::byte> records);
  [[nodiscard]] uint64_t points() const { return points_; }
  /// Bytes of the file.
  Result<uint64_t> finish();

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
  void count(std::span<const std::byte> records);
  void fill_in_header();

  AtomicFile file_;
  std::filesystem::path target_;
  LasHead head_;
  size_t data_offset_ = 0;
  std::vector<std::byte> waiting_;  ///< records that do not fill a chunk yet
  std::vector<Chunk> chunks_;
  uint64_t points_ = 0;
  std::array<uint64_t, 15> returns_{};
  std::array<int32_t, 3> low_{};
  std::array<int32_t, 3> high_{};
};

}  // namespace surfcast::exporter
