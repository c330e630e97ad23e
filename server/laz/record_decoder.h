#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "laz/laszip_record.h"
#include "laz/record_layout.h"

namespace surfcast::laz {

/// Decodes the records of one chunk from first to last.
class RecordDecoder {
 public:
  virtual ~RecordDecoder() = default;

  /// Fills `records`, a whole number of them, and no more than are left in the chunk. Records of a damaged chunk are
  /// rubbish: ask `damaged` before using them.
  virtual void decode(std::span<std::byte> records) = 0;
  [[nodiscard]] virtual bool damaged() const = 0;
};

/// `chunk` holds all bytes of a chunk of `count` points.
Result<std::unique_ptr<RecordDecoder>> decode_pointwise(const RecordLayout& layout, std::span<const std::byte> chunk);
Result<std::unique_ptr<RecordDecoder>> decode_layered(const RecordLayout& layout, std::span<const std::byte> chunk,
                                                      size_t count, bool stale_channels);

}  // namespace surfcast::laz
