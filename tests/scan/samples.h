#pragma once

#include <string>
#include <vector>

#include "scan/tile_files.h"

namespace surfcast::testing {

/// A PCD header; `fields` are its lines FIELDS to COUNT.
std::string pcd_header(const std::string& fields, int width, int height, const std::string& encoding);

/// The data block of a binary_compressed PCD file: its two sizes, and LZF data that uses literals and references.
std::string lzf_block(const std::string& data);

/// A Draco point cloud of a few hundred points with normals, colours and a generic attribute.
std::string draco_cloud(bool kd_tree);
/// Points (i, 0, 0) in their order, and as attribute 1 the number 1 - i % 2 of their batch.
std::string draco_batches(uint32_t points);

/// Two points with colours and a number, compressed.
GltfFile draco_points();

/// A small valid file of one format.
struct Sample {
  std::string name;  ///< a file name with the extension of the format
  std::string text;
};

/// One or more files of every format that is read.
std::vector<Sample> samples();

}  // namespace surfcast::testing
