#include <vector>

#include "builder/cell_tree.h"
#include "builder/kind_trees.h"
#include "gaussian/gaussian_block.h"
#include "gaussian/merge_gaussians.h"

namespace surfcast::builder {
namespace {

/// Gaussians as items of a CellTree.
class GaussianCells {
 public:
  using Items = gaussian::Gaussians;

  GaussianCells(GaussianSorter& sorted, const gaussian::BlockTraits& traits) : sorted_(sorted), traits_(traits) {}

  Result<std::optional<uint64_t>> code(size_t ahead) { return sorted_.code(ahead); }
  Result<Items> take(size_t count) { return sorted_.take(count); }
  void append_all(const Items& from, Items& to) const {
    to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
    to.scales.insert(to.scales.end(), from.scales.begin(), from.scales.end());
    to.rotations.insert(to.rotations.end(), from.rotations.begin(), from.rotations.end());
    to.opacities.insert(to.opacities.end(), from.opacities.begin(), from.opacities.end());
    to.harmonics.insert(to.harmonics.end(), from.harmonics.begin(), from.harmonics.end());
  }
  [[nodiscard]] MergedItems<Items> merge(const Items& below, const geometry::Box& cell, size_t most) const {
    gaussian::MergedGaussians merged = gaussian::merge_gaussians(below, traits_, cell, most);
    return {std::move(merged.gaussians), merged.side};
  }
  [[nodiscard]] model::EncodedBlock encode(const Items& items, bool /*coarse*/) const {
    return gaussian::encode_gaussians(items, traits_);
  }

 private:
  GaussianSorter& sorted_;
  const gaussian::BlockTraits& traits_;
};

}  // namespace

Status write_gaussian_tree(GaussianSorter& sorted, const geometry::RootCube& root, const gaussian::BlockTraits& traits,
                           model::ModelWriter& writer, const std::function<void(uint64_t)>& step) {
  GaussianCells cells(sorted, traits);
  return CellTree(cells, root, writer, step).write();
}

}  // namespace surfcast::builder
