#include <algorithm>
#include <cmath>

#include "builder/cell_tree.h"
#include "builder/kind_trees.h"
#include "ellipsoid/ellipsoid_block.h"
#include "ellipsoid/merge_ellipsoids.h"

namespace surfcast::builder {
namespace {

constexpr double kCubesAcross = 512;
constexpr double kFewestAcross = 8;

/// Ellipsoids as items of a CellTree.
class EllipsoidCells {
 public:
  using Items = ellipsoid::Ellipsoids;

  EllipsoidCells(EllipsoidSorter& sorted, const geometry::RootCube& root, const model::EllipsoidSource& source,
                 uint32_t number)
      : sorted_(sorted), root_(root), source_(source), number_(number) {}

  Result<std::optional<uint64_t>> code(size_t ahead) { return sorted_.code(ahead); }
  Result<Items> take(size_t count) { return sorted_.take(count); }
  void append_all(const Items& from, Items& to) const { ellipsoid::append_all(from, to); }
  [[nodiscard]] MergedItems<Items> merge(const Items& below, const geometry::Box& cell, size_t most) const {
    ellipsoid::MergedEllipsoids merged = ellipsoid::merge_ellipsoids(below, rule_for(cell, most));
    return {std::move(merged.ellipsoids), merged.side};
  }
  [[nodiscard]] model::EncodedBlock encode(const Items& items, bool coarse) const {
    return ellipsoid::encode_ellipsoids(items, source_, number_, coarse);
  }

 private:
  [[nodiscard]] ellipsoid::MergeRule rule_for(const geometry::Box& cell, size_t most) const {
    ellipsoid::MergeRule rule;
    rule.on_grid = source_.on_grid();
    rule.step = rule.on_grid ? source_.least_step() : std::ldexp(root_.side, -geometry::kMortonDepth);
    rule.scale = source_.scale();
    rule.most = most;
    const double side = cell.max.x - cell.min.x;
    const auto level_of = [&](double cubes) { return std::ilogb(side / cubes / rule.step); };
    rule.first_level = rule.on_grid ? 1 : std::max(1, level_of(kCubesAcross));
    rule.widest_level = std::max(rule.first_level, level_of(kFewestAcross));
    return rule;
  }

  EllipsoidSorter& sorted_;
  const geometry::RootCube& root_;
  const model::EllipsoidSource& source_;
  uint32_t number_;
};

}  // namespace

Status write_ellipsoid_tree(EllipsoidSorter& sorted, const geometry::RootCube& root,
                            const model::EllipsoidSource& source, uint32_t number, model::ModelWriter& writer,
                            const std::function<void(uint64_t)>& step) {
  EllipsoidCells cells(sorted, root, source, number);
  return CellTree(cells, root, writer, step).write();
}

}  // namespace surfcast::builder
