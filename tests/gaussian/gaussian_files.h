#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "gaussian/gaussian_reader.h"
#include "model/test_folder.h"
#include "scan/bytes.h"

namespace surfcast::testing {

/// Replaces a file. It is removed first: file systems wait for the disk when a file is overwritten.
inline std::filesystem::path write(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::remove(path);
  std::ofstream stream(path, std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  return path;
}

/// A PLY file with one element of floats.
std::string float_ply(const std::vector<std::string>& properties, const std::vector<std::vector<float>>& rows);

/// The properties of a 3DGS file of a degree; f_rest follow f_dc.
std::vector<std::string> gaussian_properties(int degree, int scales = 3);

/// A row for them: a Gaussian at (1, 2, 3) whose f_rest_k is k + 1.
std::vector<float> gaussian_row(int degree, int scales = 3);

/// A compressed PLY file: chunks of 12 or 18 floats, four words a vertex, and bytes of harmonics.
struct CompressedVertex {
  uint32_t position = 0;
  uint32_t rotation = 0;
  uint32_t scale = 0;
  uint32_t color = 0;
  std::vector<uint8_t> harmonics;
};
std::string compressed_ply(const std::vector<std::vector<float>>& chunks,
                           const std::vector<CompressedVertex>& vertices);

/// SPZ before it is packed: the header of versions 2 and 3, and the columns.
struct SpzContent {
  uint32_t version = 3;
  uint32_t count = 1;
  uint8_t degree = 0;
  uint8_t fraction_bits = 12;
  uint8_t flags = 0;
  std::vector<std::string> columns;  ///< positions, opacities, colours, scales, rotations, harmonics
};
std::string spz(const SpzContent& content);
/// Version 4: a stream for each column.
std::string spz4(const SpzContent& content, const std::string& extensions = "");
/// Two Gaussians of degree 1.
SpzContent spz_pair(uint32_t version);

/// Lossless WebP of bytes r, g, b, a.
std::string webp(int width, int height, const std::vector<uint8_t>& rgba, bool lossless = true);

/// The files of a SOG model of two Gaussians, by name; with a palette of 70 entries of degree 1.
struct SogContent {
  std::string meta;
  std::vector<std::pair<std::string, std::string>> files;
};
SogContent sog_pair(const std::string& count = "2", uint8_t label = 69);
std::filesystem::path write_sog_folder(const std::filesystem::path& folder, const SogContent& content);
/// An archive that stores the files as they are or deflated, within a folder or not.
std::string sog_zip(const SogContent& content, bool deflated, const std::string& folder = "");

/// The message with which opening or reading fails; empty if it does not.
inline std::string fault_of(const std::filesystem::path& path, const scan::DecodingLimit& limit = {}) {
  Result<gaussian::GaussianReader> reader = gaussian::GaussianReader::open(path, limit);
  if (!reader) return reader.error().message;
  while (reader->position() < reader->traits().count) {
    const Result<gaussian::Gaussians> part = reader->read(1000);
    if (!part) return part.error().message;
  }
  return {};
}

/// All Gaussians of a file.
inline gaussian::Gaussians read_whole(const std::filesystem::path& path) {
  Result<gaussian::GaussianReader> reader = gaussian::GaussianReader::open(path);
  EXPECT_TRUE(reader) << reader.error().message;
  if (!reader) return {};
  Result<gaussian::Gaussians> all = reader->read(reader->traits().count);
  EXPECT_TRUE(all) << all.error().message;
  return all.value_or(gaussian::Gaussians{});
}

}  // namespace surfcast::testing
