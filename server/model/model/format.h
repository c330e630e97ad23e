#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/block_decoder.h"
#include "model/ellipsoid_source.h"
#include "model/volume.h"

namespace surfcast::model {

/// Versions of the format. A model is written in the oldest version that can represent it, so older programs can read
/// models without later features.
inline constexpr uint32_t kSurfelVersion = 2;
inline constexpr uint32_t kKindsVersion = 3;       ///< has a table of kinds
inline constexpr uint32_t kScatterVersion = 4;     ///< has a table of kinds, a count of scatter per block, and scatter
inline constexpr uint32_t kVolumesVersion = 5;     ///< has all tables of version 4, and tables of volumes and bricks
inline constexpr uint32_t kEllipsoidsVersion = 6;  ///< has all tables of version 5, and one of sources of ellipsoids
inline constexpr size_t kHeaderBytes = 64;
inline constexpr size_t kBlockRecordBytes = 92;
/// Limits of the format. They bound the memory that a hostile table can make the reader allocate for one block.
inline constexpr uint32_t kMaxBlockSurfels = 32768;
inline constexpr uint32_t kMaxScalars = 128;
inline constexpr uint32_t kMaxKinds = 255;

uint64_t checksum_of(std::span<const std::byte> bytes);

/// The first kHeaderBytes of a file.
struct ModelHeader {
  uint32_t version = kSurfelVersion;
  bool oriented = false;
  bool z_up = true;
  int color_bits = 0;
  bool upside_down = false;
  int harmonics_degree = 0;
  bool even = false;
  uint64_t file_bytes = 0;
  uint64_t directory_offset = 0;
  uint64_t directory_bytes = 0;
  uint64_t directory_checksum = 0;
  uint64_t georeference_offset = 0;  ///< of Georeference, which reaches to the directory; 0: the file has none
};

std::vector<std::byte> write_header(const ModelHeader& header);
/// The fault of a file that does not begin like a model.
inline constexpr const char* kNoModel = "not a Surfcast model";

/// Checks magic, version and checksum, and that the directory lies within a file of `file_bytes`. `head`: the first
/// kHeaderBytes of the file, or all of a smaller one.
Result<ModelHeader> read_header(std::span<const std::byte> head, uint64_t file_bytes);
inline Result<ModelHeader> read_header(std::span<const std::byte> file) {
  return read_header(file, file.size());
}

/// One record of the table of blocks.
struct BlockRecord {
  uint32_t parent = ldc::BlockEntry::kNoParent;
  ldc::OctreeKey key;
  uint32_t grid = 0;  ///< index into Directory::grids
  glm::i64vec3 origin{0};
  glm::u32vec3 extent{0};
  uint32_t items = 0;
  float spacing = 0;
  float max_radius = 0;
  std::optional<geometry::NormalCone> normals;
  uint64_t offset = 0;
  uint32_t bytes = 0;
  uint64_t checksum = 0;
  uint8_t kind = 0;      ///< index into Directory::kinds
  uint32_t scatter = 0;  ///< surfels that lie on no surface
  uint32_t brick = 0;    ///< of a block of a volume: index into Directory::bricks
};

/// The tables at the end of a file.
struct Directory {
  std::vector<std::string> source_names;
  std::vector<ScalarColumn> scalars;
  std::vector<surfel::Grid> grids;
  std::vector<BlockRecord> blocks;  ///< parents before children, siblings contiguous
  std::vector<AttributeRange> ranges;
  std::vector<ClassCount> classes;  ///< by code
  std::vector<std::string> kinds{std::string(kSurfelKind)};
  std::vector<Volume> volumes;
  std::vector<BrickRecord> bricks;  ///< of the blocks of kind "grid"
  std::vector<EllipsoidSource> ellipsoids;

  /// The oldest version of the format that can represent the tables.
  [[nodiscard]] uint32_t version() const {
    if (!ellipsoids.empty()) return kEllipsoidsVersion;
    if (!volumes.empty()) return kVolumesVersion;
    const auto has_scatter = [](const BlockRecord& block) { return block.scatter > 0; };
    if (std::any_of(blocks.begin(), blocks.end(), has_scatter)) return kScatterVersion;
    return kinds.size() == 1 && kinds.front() == kSurfelKind ? kSurfelVersion : kKindsVersion;
  }
};

std::vector<std::byte> write_directory(const Directory& directory);
/// Checks every field that later code relies on; blocks must lie between the header and the directory. The caller
/// checks whether the blocks form a tree.
Result<Directory> read_directory(std::span<const std::byte> bytes, const ModelHeader& header);

}  // namespace surfcast::model
