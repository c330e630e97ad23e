#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "grid/stored_grid.h"

namespace surfcast::grid {

/// Reads the samples of a regular grid from the first to the last: i fastest, then j, then k. The memory that it takes
/// depends on the format, not on the size of the grid: some buffers, and the window of a decoder.
class GridReader {
 public:
  /// Opens NRRD, MetaImage, VTK image data (legacy and XML), NIfTI or MRtrix, detected by content. `array` names the
  /// array of a VTK file; empty: its active one. `order`: of six components of which a NIfTI file does not say that
  /// they are a tensor; without it they are refused. Fails on colours and other components that are not a tensor, and
  /// where the file cannot hold as many samples as it states. Every error names the file and the fault.
  static Result<GridReader> open(const std::filesystem::path& path, std::string_view array = {},
                                 std::optional<TensorOrder> order = {});

  /// The same for samples that are made, not stored in a file of a format. `path` only names them.
  static Result<GridReader> of(const std::filesystem::path& path, StoredGrid grid);

  [[nodiscard]] const GridHeader& header() const { return grid_.header; }
  /// The files beside the header's that hold the samples.
  [[nodiscard]] std::vector<std::filesystem::path> data_files() const;
  /// Samples read so far, or passed over.
  [[nodiscard]] uint64_t position() const { return position_; }

  /// Reads the next samples: `samples` is a multiple of header().sample_bytes() and at most the rest. Components are
  /// next to each other, in this machine's byte order.
  Status read(std::span<std::byte> samples);
  /// The same as numbers, without slope and intercept. Integers above 2^53 are rounded.
  Status read(std::span<double> values);

  /// Goes to a sample. Forward, samples that are stored as they are cost nothing and others are decoded; backward,
  /// decoding begins again.
  Status seek(uint64_t sample);

 private:
  GridReader(std::filesystem::path path, StoredGrid grid) : path_(std::move(path)), grid_(std::move(grid)) {}
  Status restart();
  Status read_planes(std::span<std::byte> samples);
  Status finish();
  [[nodiscard]] Status named(Status status) const;

  std::filesystem::path path_;
  StoredGrid grid_;
  std::vector<stream::StreamPtr> streams_;  ///< one, or one for each component of planar samples
  uint64_t position_ = 0;
};

}  // namespace surfcast::grid
