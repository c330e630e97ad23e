#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"

namespace surfcast::exporter {

/// Writes point records of LAS, which appear under the name of the target when `finish` has succeeded.
class RecordWriter {
 public:
  RecordWriter() = default;
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;
  virtual ~RecordWriter() = default;

  /// Appends whole records.
  virtual Status append(std::span<const std::byte> records) = 0;
  [[nodiscard]] virtual uint64_t points() const = 0;
  /// Bytes that were written.
  virtual Result<uint64_t> finish() = 0;

 protected:
  RecordWriter(RecordWriter&&) = default;
  RecordWriter& operator=(RecordWriter&&) = default;
};

}  // namespace surfcast::exporter
