#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "estimation/neighbours.h"
#include "point_tree/block_table.h"
#include "point_tree/node_points.h"
#include "scan/table_meaning.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::point_tree {

/// A block that was made: some surfels of a cloud, none if there are no points.
struct MadeBlock {
  uint32_t block = 0;  ///< its number
  std::shared_ptr<const surfel::SurfelCloud> cloud;
  std::vector<uint32_t> members;
  surfel::Grid grid;
};

/// The points of a node and its ancestors, the root first.
using PointPath = std::vector<std::shared_ptr<const NodePoints>>;

/// The surfels of a cell, along the Morton order.
struct CellSurfels {
  surfel::SurfelCloud cloud;    ///< without weights if no leaf has some of them
  std::vector<uint64_t> codes;  ///< of its surfels, see Cells::code_of
  /// The same surfels as they stand for finer ones; none of a node that has no child.
  std::optional<surfel::SurfelCloud> coarse;
};

/// The surfels of a cell and its halo, without weights. Those of the cell come first, along the Morton order.
struct EstimatedCell {
  surfel::SurfelCloud cloud;
  std::vector<uint64_t> codes;  ///< of the surfels of the cell
  estimation::Neighbourhoods neighbourhoods;
};

/// The surfels of the cell of a node: its points and those of its ancestors there. The points of the ancestors around
/// the cell are the halo, from which normals, radii and kinds near the border are found as well. Duplicates are left
/// out, as in a build. The signs of normals that are estimated are resolved for the root, and open in other cells.
EstimatedCell estimate_cell(const NodeTree& tree, uint32_t node, const PointPath& path,
                            const scan::TableMeaning& meaning);

/// Adds the weights, and the surfels that stand for finer ones; leaves out the halo.
CellSurfels finish_cell(const NodeTree& tree, uint32_t node, EstimatedCell estimated);

/// Divides the surfels of a node among its blocks. `radius`: of surfels at the spacing of the tree. An error if a leaf
/// has more points than its blocks have room for.
Result<std::vector<MadeBlock>> divide_surfels(const NodeTree& tree, const BlockTable& table, uint32_t node,
                                              CellSurfels surfels, double radius);

/// What the surfels of the root tell of those of all levels.
struct RootFacts {
  double radius = 0;   ///< median of those on surfaces, world units
  double scatter = 0;  ///< share of those on none
};
RootFacts measure_root(const NodeTree& tree, const CellSurfels& root);

}  // namespace surfcast::point_tree
