#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "scan/scan_points.h"
#include "scan/scan_schema.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

/// Calls `use(vector)` with every array that points or surfels of a schema have, in a fixed order. ScanPoints and
/// SurfelCloud use the same names.
template <typename Points, typename Use>
void for_each_column(Points& points, const Use& use) {
  use(points.positions);
  if (!points.normals.empty()) use(points.normals);
  if (!points.radii.empty()) use(points.radii);
  if (points.colors) use(points.colors->values);
  for (auto& scalar : points.scalars) std::visit(use, scalar.values);
}

/// A cloud of this schema with `size` surfels, all zero.
surfel::SurfelCloud empty_cloud(const scan::ScanSchema& schema, size_t size);

/// Copies all points to the surfels of the cloud from `first` on. Both must have the same schema.
void copy_points(const scan::ScanPoints& points, size_t first, surfel::SurfelCloud& cloud);

/// Appends the columns of the points `rows` to `bytes`, one column after another.
void append_columns(const scan::ScanPoints& points, std::span<const uint32_t> rows, std::vector<std::byte>& bytes);

/// The destinations for `count` points that `append_columns` wrote: for each column, the memory of the cloud's surfels
/// from `first` on.
std::vector<std::span<std::byte>> column_memory(surfel::SurfelCloud& cloud, size_t first, size_t count);

}  // namespace surfcast::builder
