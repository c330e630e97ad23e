#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "laz/chunk_table.h"
#include "laz/laszip_record.h"
#include "laz/record_decoder.h"
#include "laz/record_layout.h"

namespace surfcast::laz {

/// What the header of a LAZ file says about its points.
struct LazPoints {
  int point_format = 0;      ///< without the bits that mark the file as compressed
  size_t record_length = 0;  ///< in bytes, uncompressed
  uint64_t count = 0;
  size_t data_offset = 0;  ///< in the file
};

/// Decodes the points of one chunk in order, in pieces of any size.
class LazChunkReader {
 public:
  /// Fills `records` with the next ones: a whole number of them, no more than the chunk has left.
  Status read(std::span<std::byte> records);

 private:
  friend class LazFile;
  LazChunkReader(std::unique_ptr<laz::RecordDecoder> decoder, size_t left)
      : decoder_(std::move(decoder)), left_(left) {}

  std::unique_ptr<laz::RecordDecoder> decoder_;
  size_t left_;  ///< bytes of records
};

/// The compressed points of a LAZ file (LASzip 2.0 and later, point formats 0 to 3 and 6 to 8). Points come in chunks
/// that are decoded independently of each other, into records of the layout that an uncompressed LAS file has.
class LazFile {
 public:
  /// Checks the description of the coding and the chunk table against the bytes that are there. `laszip_record` is the
  /// body of the variable length record "laszip encoded". Refers to `file`, which has to outlive this.
  static Result<LazFile> open(std::span<const std::byte> file, const LazPoints& points,
                              std::span<const std::byte> laszip_record);

  /// In file order, all points of the file. A damaged chunk shows only when it is decoded: its count is a claim.
  [[nodiscard]] std::span<const laz::Chunk> chunks() const { return chunks_; }
  [[nodiscard]] size_t record_length() const { return layout_.length; }

  /// Safe to call from many threads at once.
  [[nodiscard]] Result<LazChunkReader> read_chunk(const laz::Chunk& chunk) const;

 private:
  LazFile(std::span<const std::byte> file, const laz::RecordLayout& layout, const laz::LaszipRecord& coding,
          std::vector<laz::Chunk> chunks)
      : file_(file), layout_(layout), coding_(coding), chunks_(std::move(chunks)) {}

  std::span<const std::byte> file_;
  laz::RecordLayout layout_;
  laz::LaszipRecord coding_;
  std::vector<laz::Chunk> chunks_;
};

}  // namespace surfcast::laz
