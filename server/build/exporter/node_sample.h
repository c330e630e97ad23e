#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "exporter/even_sample.h"

namespace surfcast::exporter {

/// The points of a child among those from which the sample of a node is taken.
struct ChildPoints {
  size_t first = 0;
  size_t count = 0;
  bool has_nodes = false;  ///< below the child
};

/// The numbers of the points, in ascending order, of the sample of a node at a depth among those of its children, which
/// follow each other. Many readers look for no nodes below an empty one. So of each child that has nodes below it one
/// point at least stays, and the sample has a point for each node from here up to the root, even where points are too
/// close together for that. That takes so many points in the children, beside those that stay.
std::vector<uint32_t> node_sample(std::span<const SamplePoint> points, std::span<const ChildPoints> children,
                                  int depth);

}  // namespace surfcast::exporter
