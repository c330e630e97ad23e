#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ldc/octree_key.h"

namespace surfcast::exporter {

/// A page of the hierarchy of an octree in a file: nodes, and the pages of what is below them.
struct NodePage {
  std::vector<size_t> nodes;     ///< numbers of nodes; that of the topmost comes first
  std::vector<size_t> subpages;  ///< numbers of pages
};

/// Divides the nodes of an octree into pages, the first of which has the root. Every node is in one page. A page other
/// than the first has a node and all below it, at most `most`. The first has the nodes that have more than that below
/// them, and subtrees that are too small for pages of their own. `nodes`: in any order, with all their ancestors.
std::vector<NodePage> make_pages(std::span<const ldc::OctreeKey> nodes, size_t most);

}  // namespace surfcast::exporter
