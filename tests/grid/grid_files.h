#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "grid/grid_reader.h"
#include "model/test_folder.h"
#include "scan/bytes.h"

namespace surfcast::testing {

/// The samples of the files below: 3 x 2 x 2, i fastest.
inline const std::vector<int16_t> kRamp = {-5, -4, -3, 0, 1, 2, 300, 301, 302, 32767, -32768, 7};

/// Numbers as bytes.
template <typename T>
std::string packed_numbers(const std::vector<T>& values, bool big = false) {
  Bytes bytes;
  for (const T value : values) bytes.add<T>(value, big);
  return bytes.text();
}

inline std::string ramp_bytes(bool big = false) {
  return packed_numbers(kRamp, big);
}

inline std::string ramp_text() {
  std::string text;
  for (const int16_t value : kRamp) text += std::to_string(value) + " ";
  return text;
}

/// A NIfTI header with these settings; samples are put behind it.
struct NiftiSettings {
  int version = 1;
  bool big = false;
  bool pair = false;
  int16_t type = 4;
  int16_t intent = 0;
  std::vector<int64_t> sizes = {3, 2, 2};
  std::vector<double> spacing = {1, 2, 3, 4};  ///< the first is the sign of qform
  double slope = 0;
  double intercept = 0;
  int qform = 0;
  int sform = 0;
  std::vector<double> quaternion = std::vector<double>(6);
  std::vector<double> rows = std::vector<double>(12);
  uint8_t units = 2;
};
std::string nifti_header(const NiftiSettings& settings);

/// A .vti file of 16 bit integers: attributes of VTKFile and ImageData, the array element, what follows the image.
std::string vti(const std::string& file_attributes, const std::string& image_attributes, const std::string& array,
                const std::string& behind = "");
inline const std::string kVtiExtent = R"(WholeExtent="0 2 0 1 0 1")";

/// VTK's block header and blocks of 10 bytes, packed by zlib, as runs that base64 keeps apart.
struct VtkBlocks {
  std::string header;
  std::string blocks;
};
VtkBlocks vtk_blocks(std::string_view bytes, bool wide, bool big);

/// A file of one format with the ramp, complete in itself.
struct GridSample {
  std::string name;
  std::string text;
};
std::vector<GridSample> grid_samples();

/// Replaces a file. It is removed first: file systems wait for the disk when a file is overwritten.
inline std::filesystem::path write(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::remove(path);
  std::ofstream stream(path, std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  return path;
}

/// The samples of a grid as numbers, or the error.
inline Result<std::vector<double>> read_values(grid::GridReader& reader) {
  std::vector<double> values(reader.header().samples() * reader.header().components());
  if (Status status = reader.read(std::span(values)); !status) return fail(status);
  return values;
}

/// The message with which opening or reading fails; empty if it does not.
inline std::string fault_of(const std::filesystem::path& path, std::string_view array = {}) {
  Result<grid::GridReader> reader = grid::GridReader::open(path, array);
  if (!reader) return reader.error().message;
  const Result<std::vector<double>> values = read_values(*reader);
  return values ? std::string() : values.error().message;
}

/// Expects a file with the ramp; returns its header.
inline grid::GridHeader expect_ramp(const std::filesystem::path& path, std::string_view array = {}) {
  Result<grid::GridReader> reader = grid::GridReader::open(path, array);
  EXPECT_TRUE(reader) << reader.error().message;
  if (!reader) return {};
  const Result<std::vector<double>> values = read_values(*reader);
  EXPECT_TRUE(values) << values.error().message;
  if (values) {
    EXPECT_EQ(*values, std::vector<double>(kRamp.begin(), kRamp.end()));
  }
  return reader->header();
}

/// The world position of an index.
inline glm::dvec3 world(const grid::GridHeader& header, double i, double j, double k) {
  return header.index_to_world * glm::dvec4(i, j, k, 1);
}

}  // namespace surfcast::testing
