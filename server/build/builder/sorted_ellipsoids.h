#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/result.h"
#include "builder/sorted_records.h"
#include "ellipsoid/ellipsoids.h"
#include "geometry/morton.h"
#include "model/ellipsoid_source.h"

namespace surfcast::builder {

/// Sorts the ellipsoids of a source by their Morton codes, those of one code in the order in which they were added
/// (SortedRecords).
class EllipsoidSorter {
 public:
  /// `bytes`: memory for the ellipsoids.
  EllipsoidSorter(std::filesystem::path target, const geometry::RootCube& root, const model::EllipsoidSource& source,
                  bool colors, uint64_t bytes);

  Status add(const ellipsoid::Ellipsoids& ellipsoids);
  /// Call after the last one, before reading.
  Status finish() { return records_.finish(); }

  /// See SortedRecords.
  Result<std::optional<uint64_t>> code(size_t ahead) { return records_.code(ahead); }
  /// Takes the next `count` ellipsoids; there must be as many. Of a source without a grid Ellipsoids::samples are the
  /// cells of the root cube at its greatest depth.
  Result<ellipsoid::Ellipsoids> take(size_t count);

 private:
  [[nodiscard]] ellipsoid::Ellipsoids empty_columns() const;

  geometry::RootCube root_;
  const model::EllipsoidSource& source_;
  bool colors_;
  std::vector<std::byte> record_;
  SortedRecords records_;
};

}  // namespace surfcast::builder
