#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "grid/grid_reader.h"
#include "model/volume.h"

namespace surfcast::builder {

/// True if the file begins like a regular grid, whatever its name. False also if it cannot be read.
[[nodiscard]] bool is_grid(const std::filesystem::path& path);

/// A regular grid with one number a sample, as the source of a volume. All errors name the file.
class GridInput {
 public:
  /// With `sample`, every kth sample along each axis alone, so many that they are at most that number: a preview.
  static Result<GridInput> open(const std::filesystem::path& path, std::optional<uint64_t> sample = {});

  /// The same for samples from elsewhere. `path` only names them.
  static Result<GridInput> of(const std::filesystem::path& path, grid::GridReader reader,
                              std::optional<uint64_t> sample);

  /// Reads all samples for the range of values. Calls `plane_done` after each plane.
  Status measure(const std::function<void()>& plane_done);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const grid::GridHeader& header() const { return reader_.header(); }
  /// The volume as far as it is known: all of it after all planes have been read.
  [[nodiscard]] const model::Volume& volume() const { return volume_; }
  /// Samples that are not finite; they become the lowest sample. Known after measure().
  [[nodiscard]] uint64_t not_finite() const { return not_finite_; }
  /// True if all finite samples are integers, of whatever type. Known after measure().
  [[nodiscard]] bool integral() const { return integral_; }
  /// Samples of the file, which are more than those of the volume if only every few of them are read.
  [[nodiscard]] uint64_t samples_of_file() const { return header().samples(); }
  /// True if a float cannot hold all samples exactly.
  [[nodiscard]] bool needs_doubles() const;

  /// Reads the next plane and counts it in the histogram; `samples` are size.x * size.y, without slope and intercept.
  template <typename Sample>
  Status read_plane(std::span<Sample> samples);

 private:
  GridInput(std::filesystem::path path, grid::GridReader reader, uint64_t stride);
  Status read_next(std::span<double> samples);
  Status read_row();
  Status rewind();
  Status read_part(std::span<double> samples);
  [[nodiscard]] Status failed(ErrorKind kind, const std::string& what) const;
  void count(std::span<const double> samples);

  std::filesystem::path path_;
  grid::GridReader reader_;
  const uint64_t stride_;    ///< one of so many samples along each axis is read
  std::vector<double> row_;  ///< of the volume, the last one that was read; empty if all samples are
  size_t column_ = 0;        ///< the next sample of it
  uint64_t next_row_ = 0;
  model::Volume volume_;
  double low_ = 0;  ///< of the samples
  double high_ = 0;
  uint64_t not_finite_ = 0;
  bool integral_ = true;
};

}  // namespace surfcast::builder
