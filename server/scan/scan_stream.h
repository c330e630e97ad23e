#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "base/mapped_file.h"
#include "base/result.h"
#include "geometry/box.h"
#include "scan/row_source.h"
#include "scan/scan_points.h"
#include "scan/table_meaning.h"

namespace surfcast::scan {

/// A scan whose points are delivered in pieces of bounded size, as often as wanted. Opening it reads the whole file
/// once (on all threads), so that everything about it is known beforehand and damage is found before work is done.
class ScanStream {
 public:
  /// A scan of any supported format, told apart by content first and extension second. Every failure names the file and
  /// the fault; a file without points is a failure.
  static Result<ScanStream> open(const std::filesystem::path& path, const DecodingLimit& limit = {});
  /// The same for a file's content in memory, which must outlive the stream; `path` only names it.
  static Result<ScanStream> open_content(std::span<const std::byte> bytes, const std::filesystem::path& path);

  [[nodiscard]] const ScanSchema& schema() const { return meaning_.schema; }
  [[nodiscard]] uint64_t size() const { return size_; }                  ///< points, unusable ones included
  [[nodiscard]] const geometry::Box& bounds() const { return bounds_; }  ///< of the points with finite coordinates
  [[nodiscard]] size_t pieces() const { return rows_->pieces(); }
  [[nodiscard]] uint64_t held_bytes() const { return rows_->held_bytes(); }  ///< of memory, for formats decoded whole
  /// Some of the points; all pieces in their order are all of them in theirs. Any thread may ask.
  [[nodiscard]] Result<ScanPoints> read(size_t piece) const;

 private:
  Status examine(std::span<const std::byte> bytes, const std::filesystem::path& path, const DecodingLimit& limit);

  std::filesystem::path path_;
  std::optional<MappedFile> file_;  ///< none for content that others hold
  std::unique_ptr<RowSource> rows_;
  TableMeaning meaning_;
  uint64_t size_ = 0;
  geometry::Box bounds_;
};

}  // namespace surfcast::scan
