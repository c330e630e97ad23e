#pragma once

#include <cstdint>

#include "base/result.h"
#include "scan/scan_points.h"

namespace surfcast::exporter {

/// Writes points of one schema into a file, which appears under its name when `finish` has succeeded.
class PointWriter {
 public:
  PointWriter() = default;
  PointWriter(const PointWriter&) = delete;
  PointWriter& operator=(const PointWriter&) = delete;
  virtual ~PointWriter() = default;

  virtual Status append(const scan::ScanPoints& points) = 0;
  /// Points of those appended that are in the file.
  [[nodiscard]] virtual uint64_t written() const = 0;
  /// Bytes of the file.
  virtual Result<uint64_t> finish() = 0;
};

}  // namespace surfcast::exporter
