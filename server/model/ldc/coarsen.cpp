#include "ldc/coarsen.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <unordered_set>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "ldc/reduce.h"
#include "surfel/normalization_weights.h"

namespace surfcast::ldc {
namespace {

/// A cell that gets a coarse block, the front cells in it, and the result of coarsening.
struct CoarsenedCell {
  OctreeKey key;
  std::vector<FrontCell> parts;
  CoarseCell coarse;
};

/// Cells by location; an ordered map, because the order of the blocks must not depend on hashing.
using CoarsenedCells = std::map<uint64_t, CoarsenedCell>;

CoarsenedCells take_parts(Front& front, int depth) {
  const auto ready = std::stable_partition(front.begin(), front.end(),
                                           [depth](const FrontCell& cell) { return cell.key.depth <= depth; });
  CoarsenedCells coarsened;
  for (auto cell = ready; cell != front.end(); ++cell) {
    const OctreeKey parent = cell->key.parent();
    CoarsenedCell& at = coarsened[location_of(parent)];
    at.key = parent;
    at.parts.push_back(std::move(*cell));
  }
  front.erase(ready, front.end());
  return coarsened;
}

void append(std::vector<CoarseSurfel>& to, std::span<const CoarseSurfel> more) {
  to.insert(to.end(), more.begin(), more.end());
}

std::vector<CoarseSurfel> surfels_of(const FrontCell& cell, const surfel::SurfelCloud* cloud) {
  return cell.members.empty() ? cell.surfels : sample_surfels(*cloud, cell.members, cell.largest_radius);
}

std::vector<CoarseSurfel> surfels_of(std::span<const FrontCell> cells, const surfel::SurfelCloud* cloud) {
  std::vector<CoarseSurfel> surfels;
  for (const FrontCell& cell : cells) append(surfels, surfels_of(cell, cloud));
  return surfels;
}

template <typename Values, typename Work>
void for_each_value(Values& values, Work work) {
  oneapi::tbb::parallel_for(size_t{0}, values.size(), [&](size_t i) { work(values[i]); });
}

/// The coarsened cells, their neighbours of the same depth, and all ancestors of these.
class Nearby {
 public:
  Nearby(const CoarsenedCells& coarsened, int depth) : depth_(depth) {
    for (const auto& [location, cell] : coarsened) add_neighbours(cell.key);
  }
  [[nodiscard]] int depth() const { return depth_; }
  [[nodiscard]] bool contains(const OctreeKey& key) const { return locations_.count(location_of(key)) != 0; }

 private:
  void add_neighbours(const OctreeKey& key) {
    const uint32_t cells = uint32_t{1} << key.depth;
    for (uint32_t i = 0; i < 27; ++i) {
      // Below 0 the unsigned coordinate wraps around to a value beyond the last cell.
      const OctreeKey neighbour{key.depth, key.x + i % 3 - 1, key.y + i / 3 % 3 - 1, key.z + i / 9 - 1};
      if (neighbour.x < cells && neighbour.y < cells && neighbour.z < cells) add_with_parents(neighbour);
    }
  }
  void add_with_parents(OctreeKey key) {
    while (locations_.insert(location_of(key)).second && key.depth > 0) key = key.parent();
  }

  int depth_;
  std::unordered_set<uint64_t> locations_;
};

OctreeKey cell_of(const CoarseSurfel& surfel, const geometry::RootCube& root, int depth) {
  return key_of_code(geometry::morton_code(root, surfel.position), depth);
}

std::vector<CoarsenedCell*> pointers_to(CoarsenedCells& cells) {
  std::vector<CoarsenedCell*> list;
  list.reserve(cells.size());
  for (auto& [location, cell] : cells) list.push_back(&cell);
  return list;
}

/// Coarsens the surfels around the part that lie near coarsened cells, cell by cell.
void raise_around(std::vector<CoarseSurfel>& around, const Nearby& nearby, const LevelSources& sources) {
  CoarsenedCells cells;
  std::vector<CoarseSurfel> rest;
  for (const CoarseSurfel& s : around) {
    const OctreeKey key = cell_of(s, sources.root, nearby.depth());
    if (!nearby.contains(key)) {
      rest.push_back(s);
      continue;
    }
    CoarsenedCell& cell = cells[location_of(key)];
    cell.key = key;
    if (cell.parts.empty()) cell.parts.emplace_back();
    cell.parts.front().surfels.push_back(s);
  }
  std::vector<CoarsenedCell*> list = pointers_to(cells);
  for_each_value(list, [&](CoarsenedCell* cell) {
    cell->coarse = reduce(cell->parts.front().surfels, sources.root, cell->key, sources.attributes.oriented);
  });
  for (const CoarsenedCell* cell : list) append(rest, cell->coarse.surfels);
  around = std::move(rest);
}

surfel::SurfelCloud geometry_of(std::span<const CoarseSurfel> surfels, bool oriented) {
  surfel::SurfelCloud cloud;
  cloud.oriented = oriented;
  for (const CoarseSurfel& s : surfels) {
    cloud.positions.push_back(s.position);
    cloud.normals.push_back(s.normal);
    cloud.radii.push_back(s.radius);
    cloud.scatter.push_back(s.scatter ? 1 : 0);
  }
  return cloud;
}

/// Weights of the surfels of the coarsened cells, in the order of the cells.
std::vector<float> find_weights(const CoarsenedCells& coarsened, const Front& waiting, const Nearby& nearby,
                                const LevelSources& sources) {
  std::vector<CoarseSurfel> level;
  for (const auto& [location, cell] : coarsened) append(level, cell.coarse.surfels);
  const size_t wanted = level.size();
  for (const FrontCell& cell : waiting) {
    if (nearby.contains(cell.key)) append(level, surfels_of(cell, sources.cloud));
  }
  for (const CoarseSurfel& s : sources.around) {
    if (nearby.contains(cell_of(s, sources.root, nearby.depth()))) level.push_back(s);
  }
  std::vector<float> weights = surfel::normalization_weights(geometry_of(level, sources.attributes.oriented));
  weights.resize(wanted);
  return weights;
}

/// The blocks that show the cells, each once.
std::vector<uint32_t> blocks_of(std::span<const FrontCell> cells) {
  std::vector<uint32_t> blocks;
  for (const FrontCell& cell : cells) blocks.insert(blocks.end(), cell.blocks.begin(), cell.blocks.end());
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

TreeBlock make_block(const CoarsenedCell& cell, std::span<const float> weights, const CoarseAttributes& attributes) {
  TreeBlock block{
      cell.key, cell.coarse.grid, {}, make_coarse_cloud(cell.coarse.surfels, attributes), blocks_of(cell.parts)};
  block.ray_spacing = cell.coarse.spacing;
  block.coarse->weights.assign(weights.begin(), weights.end());
  return block;
}

}  // namespace

std::vector<TreeBlock> coarsen(Front& front, int depth, LevelSources& sources, uint32_t first_number) {
  CoarsenedCells coarsened = take_parts(front, depth);
  std::vector<CoarsenedCell*> list = pointers_to(coarsened);
  for_each_value(list, [&](CoarsenedCell* cell) {
    cell->coarse = reduce(surfels_of(cell->parts, sources.cloud), sources.root, cell->key, sources.attributes.oriented);
  });
  const Nearby nearby(coarsened, depth);
  raise_around(sources.around, nearby, sources);
  const std::vector<float> weights = find_weights(coarsened, front, nearby, sources);

  std::vector<TreeBlock> blocks;
  size_t next = 0;
  for (CoarsenedCell* cell : list) {
    const size_t count = cell->coarse.surfels.size();
    const auto number = static_cast<uint32_t>(first_number + blocks.size());
    blocks.push_back(make_block(*cell, std::span(weights).subspan(next, count), sources.attributes));
    front.push_back({cell->key, {number}, std::move(cell->coarse.surfels)});
    next += count;
  }
  return blocks;
}

int deepest(const Front& front) {
  int depth = 0;
  for (const FrontCell& cell : front) depth = std::max<int>(depth, cell.key.depth);
  return depth;
}

}  // namespace surfcast::ldc
