#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "exporter/las_counts.h"
#include "geometry/morton.h"
#include "ldc/octree_key.h"

namespace surfcast::exporter {

/// The number of Morton codes of a cell at a depth.
inline uint64_t codes_of_cell(int depth) {
  return uint64_t{1} << (3 * (geometry::kMortonDepth - depth));
}

/// The least cube with the lowest corner of the points that holds all of them, within its upper faces. Records are
/// those of LAS, with the scale and offset of the head.
geometry::RootCube cube_of(const LasHead& head, const LasCounts& counts);

/// Where the points of records lie in the cube of an octree.
class RecordPlaces {
 public:
  RecordPlaces(const LasHead& head, const geometry::RootCube& cube);

  [[nodiscard]] size_t record_bytes() const { return record_bytes_; }
  /// The Morton codes of the points.
  [[nodiscard]] std::vector<uint64_t> codes(std::span<const std::byte> records) const;
  /// The place of a point in a cell, each coordinate from 0 to 1.
  [[nodiscard]] glm::vec3 place_in(const ldc::OctreeKey& cell, const std::byte* record) const;

 private:
  [[nodiscard]] glm::dvec3 position(const std::byte* record) const;

  size_t record_bytes_;
  glm::dvec3 scale_;
  glm::dvec3 offset_;
  geometry::RootCube cube_;
};

}  // namespace surfcast::exporter
