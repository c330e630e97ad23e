#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "grid/grid_header.h"
#include "stream/mapped_stream.h"

namespace surfcast::grid {

/// A header, and how the samples behind it are stored. Each format makes one.
struct StoredGrid {
  GridHeader header;
  bool swapped = false;  ///< samples are in the byte order that is not this machine's
  bool planar = false;   ///< all samples of the first component come first, then those of the next
  /// A new stream of the samples, component fastest unless planar, of exactly their size or truncated.
  std::function<Result<stream::StreamPtr>()> open;
  /// The files that hold the samples; none if the header's own file does. A header may state any number of them; all
  /// are there once the samples are open.
  uint64_t data_files = 0;
  std::function<std::filesystem::path(uint64_t)> data_file;
};

/// A file that is to be read as a grid.
struct GridFile {
  std::filesystem::path path;
  stream::FilePtr file;
  std::string array;                   ///< the array wanted of a file with several; empty: the one the file prefers
  std::optional<TensorOrder> order{};  ///< of tensors whose order the file does not state

  [[nodiscard]] std::string_view text() const {
    const auto bytes = file->bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
};

enum class Packing { kRaw, kText, kInflate, kBzip2 };

/// Samples in one or more files that follow each other. Each file holds the same number of bytes of samples.
struct StoredSamples {
  Packing packing = Packing::kRaw;
  ScalarType type = ScalarType::kUint8;
  uint64_t bytes = 0;      ///< of all samples, unpacked
  uint64_t line_skip = 0;  ///< lines before the samples in each file
  int64_t byte_skip = 0;   ///< bytes before the samples in each file, unpacked; -1: the samples end the file
  uint64_t offset = 0;     ///< of line_skip in each file
  stream::FilePtr file;    ///< the only file, or none:
  uint64_t files = 1;
  std::function<std::filesystem::path(uint64_t)> name;
};

/// Notes in a grid which files its samples are in, and how they are opened.
void store(StoredSamples samples, StoredGrid& grid);

/// Opens the samples. Fails if a file is missing, or holds fewer bytes than its share where that can be told.
Result<stream::StreamPtr> open_samples(const StoredSamples& samples);

/// The path of a file that a header names, in the folder of the header. Names that lead out of the folder are refused.
Result<std::filesystem::path> beside(const std::filesystem::path& header, std::string_view name);

/// Files that a header names by a pattern like "slice%03d.raw" and a range.
struct FilePattern {
  std::filesystem::path folder;
  std::string before;
  std::string after;
  int width = 0;
  bool zeros = false;
  int64_t first = 0;
  int64_t step = 1;
  uint64_t count = 0;

  [[nodiscard]] std::filesystem::path name(uint64_t i) const;
};

/// Parses "PATTERN FIRST LAST STEP"; none if the text is not a pattern with %d.
Result<std::optional<FilePattern>> parse_pattern(const std::filesystem::path& header, std::string_view text);

}  // namespace surfcast::grid
