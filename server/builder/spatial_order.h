#pragma once

#include "builder/part_store.h"
#include "geometry/morton.h"

namespace surfcast::builder {

/// Sorts the points of every source of the cloud in Morton order, so that neighbours in space are neighbours in memory
/// in everything that follows. Points in one of the smallest cells keep their order. Returns false if there may be
/// points at one position: if two points share a smallest cell, or if there are several inputs.
bool sort_spatially(PartPoints& points, const geometry::RootCube& root);

}  // namespace surfcast::builder
