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
#include "scan/selection.h"
#include "scan/table_meaning.h"

namespace surfcast::scan {

struct ScanFolder;

/// What reading all of a scan tells about it.
struct ScanFacts {
  TableMeaning meaning;
  uint64_t points = 0;          ///< including unusable ones
  uint64_t points_of_file = 0;  ///< beyond a sample too
  geometry::Box bounds;         ///< of the points with finite coordinates
};

/// A scan whose points are read in pieces of bounded size, any number of times. Opening reads the whole file once (on
/// all threads) to collect the properties of the scan and to find damage before any work is done.
class ScanStream {
 public:
  /// Opens a scan of any supported format, detected by content first and extension second. Every error names the file
  /// and the fault; a file without points is an error. With `sample`, the scan has only about that many of the file's
  /// points, see sample_rows; they stay in memory.
  /// A scan in many files is named by its folder or by the file that describes it (see scan_folder.h). With a
  /// selection, the scan has only the points in it; a file with an index is read only where they may be.
  static Result<ScanStream> open(const std::filesystem::path& path, const DecodingLimit& limit = {},
                                 std::optional<uint64_t> sample = {}, const Selection& selection = {});
  /// The same, without reading all of the scan: opening it before found `facts`, with the same selection.
  static Result<ScanStream> reopen(const std::filesystem::path& path, const DecodingLimit& limit,
                                   const Selection& selection, const ScanFacts& facts);
  /// The same for content in memory, which must outlive the stream. `path` only names it in messages.
  static Result<ScanStream> open_content(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                         const DecodingLimit& limit = {});
  /// The same for rows that are made, or read by someone else. `path` only names them.
  static Result<ScanStream> of_rows(std::unique_ptr<RowSource> rows, const std::filesystem::path& path,
                                    std::optional<uint64_t> sample, const Selection& selection = {});
  static Result<ScanStream> reopen_rows(std::unique_ptr<RowSource> rows, const std::filesystem::path& path,
                                        const Selection& selection, const ScanFacts& facts);

  [[nodiscard]] const ScanFacts& facts() const { return facts_; }
  [[nodiscard]] const ScanSchema& schema() const { return facts_.meaning.schema; }
  [[nodiscard]] uint64_t size() const { return facts_.points; }                  ///< points, including unusable ones
  [[nodiscard]] uint64_t size_of_file() const { return facts_.points_of_file; }  ///< points, beyond a sample too
  [[nodiscard]] const geometry::Box& bounds() const {
    return facts_.bounds;
  }  ///< of the points with finite coordinates
  [[nodiscard]] size_t pieces() const { return rows_->pieces(); }
  [[nodiscard]] uint64_t held_bytes() const { return rows_->held_bytes(); }  ///< memory, for formats decoded as a whole
  /// Reads one piece. The pieces in order are the points in file order. Thread-safe.
  [[nodiscard]] Result<ScanPoints> read(size_t piece) const;

 private:
  /// How a scan is opened.
  struct Opening {
    DecodingLimit limit{};
    std::optional<uint64_t> sample{};
    Selection selection{};
    const ScanFacts* facts = nullptr;  ///< null: all of it is read to find them
  };

  static Result<ScanStream> open_as(const std::filesystem::path& path, const Opening& opening);
  static Result<ScanStream> of_rows_as(std::unique_ptr<RowSource> rows, const std::filesystem::path& path,
                                       const Opening& opening);
  Status examine(std::span<const std::byte> bytes, const std::filesystem::path& path, const Opening& opening);
  Status examine_folder(const ScanFolder& folder, const std::filesystem::path& path, const Opening& opening);
  Status examine_rows(const std::filesystem::path& path, const Opening& opening);
  Status take_sample(std::optional<uint64_t> sample);

  std::filesystem::path path_;
  std::optional<MappedFile> file_;  ///< none for content in memory
  std::unique_ptr<RowSource> rows_;
  ScanFacts facts_;
};

/// All files that a scan is read from: everything in the folder of EPT, Potree and tilesets, the description first; of
/// an ESRI ASCII grid the file of its coordinate system, too.
std::vector<std::filesystem::path> files_of_scan(const std::filesystem::path& path);

/// What can be told of a scan from its header: whether it exists, has a known format, and its header makes sense.
/// Formats without a header pass.
Status check_header(const std::filesystem::path& path);

}  // namespace surfcast::scan
