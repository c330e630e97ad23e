#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "laz/laszip_record.h"
#include "laz/record_layout.h"

namespace surfcast::laz {

/// Decodes the records of one chunk sequentially.
class RecordDecoder {
 public:
  virtual ~RecordDecoder() = default;

  /// Fills `records`. Its size must be a multiple of the record length and at most the rest of the chunk. Records of a
  /// damaged chunk are meaningless: check `damaged` before using them.
  virtual void decode(std::span<std::byte> records) = 0;
  [[nodiscard]] virtual bool damaged() const = 0;
};

/// `chunk` holds all bytes of a chunk, `count` is its number of points.
Result<std::unique_ptr<RecordDecoder>> decode_pointwise(const RecordLayout& layout, std::span<const std::byte> chunk);
Result<std::unique_ptr<RecordDecoder>> decode_layered(const RecordLayout& layout, std::span<const std::byte> chunk,
                                                      size_t count, bool stale_channels);

}  // namespace surfcast::laz
