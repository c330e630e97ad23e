#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/part_store.h"
#include "geometry/morton.h"

namespace surfcast::builder {

/// The order in which the points of a part come when those of every source are sorted.
struct SpatialOrder {
  std::vector<uint32_t> points;  ///< their numbers before
  /// False if there may be points at one position: if two points share a smallest cell, or if there are several inputs.
  bool distinct = true;
};

/// The Morton order of the points of every source, so that neighbours in space are neighbours in memory in everything
/// that follows. Points in one of the smallest cells keep their order.
SpatialOrder spatial_order(const PartPoints& points, const geometry::RootCube& root);

/// Moves the points of a cloud to their places.
void reorder(surfel::SurfelCloud& cloud, std::span<const uint32_t> order);

}  // namespace surfcast::builder
