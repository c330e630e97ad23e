#pragma once

#include <cstdint>
#include <memory>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// A part of the rows of a file, and how many there are in all.
struct RowSample {
  std::unique_ptr<RowSource> rows;
  uint64_t of_rows = 0;
};

/// About `wanted` rows of a file, spread evenly over it: of every run of k successive rows the one that a hash of its
/// place chooses, so that regular rows of a scanner leave no pattern. All rows if there are no more than `wanted`.
/// Reads every piece once, on all threads, and holds the sample in memory. A truncated file is an error.
Result<RowSample> sample_rows(const RowSource& rows, uint64_t wanted);

}  // namespace surfcast::scan
