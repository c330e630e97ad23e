#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "base/mapped_file.h"
#include "base/result.h"
#include "scan/las_header.h"
#include "scan/row_filter.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// The point records of a LAS or LAZ file that are in a selection, as the file holds them (LAZ: decompressed), in
/// pieces. Every error names the file and the fault.
class LasRecords {
 public:
  static Result<LasRecords> open(const std::filesystem::path& path, const Selection& selection);

  [[nodiscard]] const LasHeader& header() const { return header_; }
  /// The bytes of the whole file, of which `header()` shows parts.
  [[nodiscard]] std::span<const std::byte> file() const { return file_.bytes(); }
  [[nodiscard]] size_t pieces() const { return rows_->pieces(); }
  /// Records of `header().record_length` bytes. The pieces in order are the points in file order. Thread-safe.
  [[nodiscard]] Result<std::vector<std::byte>> read(size_t piece) const;

 private:
  LasRecords(const std::filesystem::path& path, MappedFile file, LasHeader header, std::unique_ptr<RowSource> rows,
             RowFilter filter);

  std::filesystem::path path_;
  MappedFile file_;
  LasHeader header_;
  std::unique_ptr<RowSource> rows_;
  RowFilter filter_;
};

}  // namespace surfcast::scan
