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

/// Properties of the points, from the header of a LAZ file.
struct LazPoints {
  int point_format = 0;      ///< without the compression bits
  size_t record_length = 0;  ///< in bytes, uncompressed
  uint64_t count = 0;
  size_t data_offset = 0;  ///< in the file
};

/// Decodes the points of one chunk sequentially, in portions of any size.
class LazChunkReader {
 public:
  /// Fills `records` with the next records. Its size must be a multiple of the record length and at most the rest of
  /// the chunk. Fails if the chunk is damaged.
  Status read(std::span<std::byte> records);

 private:
  friend class LazFile;
  LazChunkReader(std::unique_ptr<laz::RecordDecoder> decoder, size_t left)
      : decoder_(std::move(decoder)), left_(left) {}

  std::unique_ptr<laz::RecordDecoder> decoder_;
  size_t left_;  ///< bytes of records left
};

/// The compressed points of a LAZ file (LASzip 2.0 and later, point formats 0 to 10). The points are stored
/// in chunks that are decoded independently, into the records of the corresponding uncompressed LAS file.
class LazFile {
 public:
  /// Checks the coding parameters and the chunk table against the file. `laszip_record` is the body of the variable
  /// length record "laszip encoded". `file` must outlive this object.
  static Result<LazFile> open(std::span<const std::byte> file, const LazPoints& points,
                              std::span<const std::byte> laszip_record);

  /// The same for chunks that something else than the chunk table states. Their order and `first` are kept.
  static Result<LazFile> open_chunks(std::span<const std::byte> file, const LazPoints& points,
                                     std::span<const std::byte> laszip_record, std::vector<laz::Chunk> chunks);

  /// All chunks in file order. Damage within a chunk is detected only when it is decoded, so its count is not
  /// trustworthy.
  [[nodiscard]] std::span<const laz::Chunk> chunks() const { return chunks_; }
  [[nodiscard]] size_t record_length() const { return layout_.length; }

  /// Thread-safe.
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
