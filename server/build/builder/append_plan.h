#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "builder/part_plan.h"
#include "geometry/box.h"
#include "geometry/morton.h"
#include "ldc/block_tree.h"
#include "ldc/octree_key.h"
#include "surfel/grid.h"

namespace surfcast::builder {

/// The octree of a model that gets more points: the root cube that holds all of them, and the cell of it that the root
/// cube was before.
struct GrownRoot {
  geometry::RootCube root;
  ldc::OctreeKey former;

  /// The cell in the grown octree that a cell was before.
  [[nodiscard]] ldc::OctreeKey key_of(const ldc::OctreeKey& before) const;
};

/// Doubles the root cube, away from its middle, until it contains the box. None if a cell of depth `deepest` would be
/// deeper than the octree.
std::optional<GrownRoot> grow_root(const geometry::RootCube& root, const geometry::Box& box, int deepest);

/// The root cube of a model, which its file does not state: its corner is that of the lattice of the root block, and
/// its side a power of two times the step of that lattice, the least in which all blocks lie in their cells. None if
/// there is no such cube.
std::optional<geometry::RootCube> root_of(std::span<const ldc::BlockEntry> blocks, const surfel::Grid& root_grid);

/// Where the points lie that are added to a model: the box of those in each cell of a fixed depth.
class NewPoints {
 public:
  explicit NewPoints(const geometry::RootCube& root) : root_(root) {}

  void add(std::span<const glm::dvec3> positions);
  /// Adds points in the same root cube.
  void add(const NewPoints& more);

  /// Points in a cell. Of cells deeper than the fixed depth an upper bound.
  [[nodiscard]] uint64_t count(const ldc::OctreeKey& cell) const;
  /// False only if no point is so near the box along every axis.
  [[nodiscard]] bool any_near(const geometry::Box& box, double reach) const;

  static constexpr int kDepth = 10;  ///< cells of 4 m in a model of 4 km

 private:
  struct Cell {
    geometry::Box bounds;
    uint64_t points = 0;
  };
  using Cells = std::map<uint64_t, Cell>;  ///< by Morton code at kDepth
  [[nodiscard]] bool any_below(const ldc::OctreeKey& key, const geometry::Box& box) const;

  geometry::RootCube root_;
  Cells cells_;
};

/// Within so many times its radius lie all neighbours that a surfel depends on: the 32 nearest on a surface lie within
/// sqrt(32 / pi) = 3.2 spacings, and the radius is 1.08 spacings.
inline constexpr double kReachOverRadius = 4;

/// What becomes of the blocks of a model that gets more points.
struct AppendPlan {
  static constexpr uint32_t kNoRegion = std::numeric_limits<uint32_t>::max();

  /// What is worked on anew: each a cell with all its points, or some children of one cell.
  std::vector<Part> regions;
  /// For each block of the model: of a leaf whose points are worked on anew the first region that may contain some;
  /// else kNoRegion. Coarse blocks with such a leaf below them are made anew.
  std::vector<uint32_t> region_of;
  std::vector<uint32_t> kept;  ///< blocks that are copied with all blocks below them
};

/// Works on a leaf anew if a new point is so near that one of its surfels may depend on it, and on its siblings that
/// are leaves, which may come to share blocks with it. `limit`: most points of a region, if it can be divided.
AppendPlan plan_append(const ldc::BlockTree& tree, const GrownRoot& root, const NewPoints& added, uint64_t limit);

}  // namespace surfcast::builder
