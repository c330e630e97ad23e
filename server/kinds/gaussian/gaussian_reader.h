#pragma once

#include <cstdint>
#include <filesystem>

#include "gaussian/gaussian_source.h"
#include "scan/row_source.h"

namespace surfcast::gaussian {

/// Reads the Gaussians of a model from the first to the last, in columns.
class GaussianReader {
 public:
  /// Opens PLY of 3D and 2D Gaussians, compressed PLY, .splat, SPZ 2 to 4, or SOG: a folder with a meta.json, that file
  /// itself, or a zip archive. Fails where a file cannot hold as many Gaussians as it states. Every error names the
  /// file and the fault. The limit is for SOG, whose pictures are held decoded.
  static Result<GaussianReader> open(const std::filesystem::path& path, const scan::DecodingLimit& limit = {});

  [[nodiscard]] const GaussianTraits& traits() const { return source_->traits(); }
  /// Gaussians read so far, unusable ones included.
  [[nodiscard]] uint64_t position() const { return position_; }
  [[nodiscard]] uint64_t held_bytes() const { return source_->held_bytes(); }

  /// The next Gaussians, at most `count`, without the unusable ones. Memory is in proportion to what is asked for.
  Result<Gaussians> read(uint64_t count);
  /// Begins again.
  void rewind() { position_ = 0; }

 private:
  GaussianReader(std::filesystem::path path, SourcePtr source) : path_(std::move(path)), source_(std::move(source)) {}

  std::filesystem::path path_;
  SourcePtr source_;
  uint64_t position_ = 0;
};

}  // namespace surfcast::gaussian
