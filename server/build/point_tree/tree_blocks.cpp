#include "point_tree/tree_blocks.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include <oneapi/tbb/task_arena.h>

#include "base/contract.h"
#include "ldc/coarse_scalars.h"
#include "model/block_encoder.h"
#include "point_tree/columns.h"

namespace surfcast::point_tree {
namespace {

/// Shares of the memory: for the points of nodes and for their fronts, which are needed again below. Blocks have the
/// rest.
constexpr size_t kPointsShare = 2;
constexpr size_t kFrontsShare = 16;
/// Besides, as a share of the same memory: blocks that wait to be written to this disk. All those of a view wait
/// together, because they are coded once the processors are idle.
constexpr size_t kWaitingShare = 2;

/// A cell takes its signs from the cell so many levels above. Those of the level directly above are slightly better,
/// but its cells would often be estimated for nothing else (docs/in-place.md).
constexpr int kFrontsAbove = 2;

/// Counts up when blocks are made in another way: those on disk are made anew then.
constexpr int kMakerVersion = 6;

size_t bytes_of_block(const model::DecodedBlock& block) {
  size_t each = sizeof(glm::ivec3) + sizeof(glm::vec3) + 2 * sizeof(float) + (block.scatter.empty() ? 0 : 1) +
                (block.colors.empty() ? 0 : sizeof(glm::u16vec3));
  return sizeof(block) + (each + bytes_of_scalars(block.scalars)) * block.size();
}

size_t bytes_of_blocks(const std::vector<model::DecodedBlock>& blocks) {
  size_t bytes = 0;
  for (const model::DecodedBlock& block : blocks) bytes += bytes_of_block(block);
  return bytes;
}

std::vector<model::ScalarColumn> columns_of_blocks(const scan::ScanSchema& schema) {
  std::vector<model::ScalarColumn> columns;
  for (const scan::ScalarField& field : schema.scalars) {
    columns.push_back({field.name, static_cast<model::ScalarCode>(field.type), ldc::is_coarse_scalar(field.name)});
  }
  return columns;
}

/// What blocks on disk are known by; empty if the source does not tell its versions apart.
std::string identity_of(const NodeReader& reader) {
  const std::string version = reader.version();
  return version.empty() ? version : "point tree " + std::to_string(kMakerVersion) + ' ' + version;
}

model::DecodedBlock without_scalars(const model::DecodedBlock& block) {
  model::DecodedBlock copy;
  copy.grid = block.grid;
  copy.oriented = block.oriented;
  copy.origin = block.origin;
  copy.indices = block.indices;
  copy.normals = block.normals;
  copy.radii = block.radii;
  copy.weights = block.weights;
  copy.scatter = block.scatter;
  copy.colors = block.colors;
  return copy;
}

/// Works on this thread alone: others are asked for other blocks, and one that waits for idle processors has to.
template <typename Work>
auto alone(const Work& work) {
  oneapi::tbb::task_arena arena(1);
  return arena.execute(work);
}

}  // namespace

TreeBlocks::TreeBlocks(TreeFrame frame, size_t memory, std::shared_ptr<model::BlockCache> cache,
                       std::shared_ptr<const NodePoints> root, const std::vector<MadeBlock>& root_blocks)
    : frame_(std::move(frame)),
      columns_(columns_of_blocks(frame_.meaning.schema)),
      root_(std::move(root)),
      points_(memory / kPointsShare),
      fronts_(memory / kFrontsShare),
      blocks_(memory - memory / kPointsShare - memory / kFrontsShare) {
  std::string identity = identity_of(*frame_.opened.reader);
  if (cache && !identity.empty()) {
    keeper_ = std::make_unique<BlockKeeper>(std::move(cache), std::move(identity), frame_.meaning.schema.color_bits,
                                            columns_, memory / kWaitingShare);
  }
  std::shared_ptr<const Blocks> blocks = take(root_blocks);
  blocks_.put(0, blocks, bytes_of_blocks(*blocks));
}

/// Blocks that were made, with values as they are on disk.
std::shared_ptr<const TreeBlocks::Blocks> TreeBlocks::take(const std::vector<MadeBlock>& made) const {
  if (keeper_) keeper_->keep(made);
  auto blocks = std::make_shared<Blocks>();
  for (const MadeBlock& block : made) {
    blocks->push_back(block.members.empty() ? model::DecodedBlock()
                                            : model::quantize_block(*block.cloud, block.members, block.grid));
  }
  return blocks;
}

bool TreeBlocks::is_kept(uint32_t block) const {
  return blocks_.has(frame_.table.plans[block].node) || (keeper_ && keeper_->contains(block));
}

/// Announces the nodes that have to be read for blocks, ancestors first.
void TreeBlocks::announce(std::span<const uint32_t> blocks) const {
  std::vector<Node> nodes;
  std::set<uint32_t> seen;
  for (const uint32_t block : blocks) {
    for (const uint32_t number : frame_.opened.tree.path_to(frame_.table.plans[block].node)) {
      const Node& node = frame_.opened.tree.nodes[number];
      if (number == 0 || node.points == 0 || points_.has(number)) continue;
      {
        const std::lock_guard lock(announced_mutex_);
        announced_[number].push_back(block);
      }
      if (seen.insert(number).second) nodes.push_back(node);
    }
  }
  if (!nodes.empty()) frame_.opened.reader->prefetch(nodes);
}

void TreeBlocks::prefetch(std::span<const uint32_t> blocks) const {
  std::vector<uint32_t> missing;
  std::ranges::copy_if(blocks, std::back_inserter(missing), [this](uint32_t block) { return !is_kept(block); });
  announce(missing);
}

/// A node stays announced as long as another block needs it.
void TreeBlocks::forget(size_t block) const {
  std::vector<uint32_t> unused;
  {
    const std::lock_guard lock(announced_mutex_);
    for (const uint32_t node : frame_.opened.tree.path_to(frame_.table.plans[block].node)) {
      const auto found = announced_.find(node);
      if (found == announced_.end() || std::erase(found->second, static_cast<uint32_t>(block)) == 0) continue;
      if (!found->second.empty()) continue;
      announced_.erase(found);
      unused.push_back(node);
    }
  }
  for (const uint32_t node : unused) frame_.opened.reader->forget(frame_.opened.tree.nodes[node]);
}

Result<std::shared_ptr<const NodePoints>> TreeBlocks::points_of(uint32_t number) const {
  if (number == 0) return root_;
  const NodeTree& tree = frame_.opened.tree;
  const Node& node = tree.nodes[number];
  const auto read = [&]() -> Result<std::shared_ptr<const NodePoints>> {
    if (node.points == 0) return std::make_shared<const NodePoints>();
    const Result<scan::PointTable> table = frame_.opened.reader->read(node);
    {
      const std::lock_guard lock(announced_mutex_);
      announced_.erase(number);
    }
    if (!table) return fail(table);
    return sort_points(*table, frame_.meaning, tree.cells, node.key).map([](NodePoints points) {
      return std::make_shared<const NodePoints>(std::move(points));
    });
  };
  return points_.get(number, read, [](const NodePoints& points) { return points.bytes(); })
      .map_error([&](const Error& error) {
        return Error{error.kind, "node " + tree.name_of(number) + ": " + error.message};
      });
}

Result<PointPath> TreeBlocks::points_to(uint32_t node) const {
  PointPath path;
  for (const uint32_t step : frame_.opened.tree.path_to(node)) {
    Result<std::shared_ptr<const NodePoints>> points = points_of(step);
    if (!points) return fail(points);
    if (step == 0 || !(*points)->codes.empty()) path.push_back(std::move(*points));
  }
  return path;
}

Result<std::shared_ptr<const Fronts>> TreeBlocks::fronts_of(uint32_t node) const {
  if (node == 0 || !frame_.fronts) return frame_.fronts;
  const auto find = [&]() -> Result<std::shared_ptr<const Fronts>> {
    const Result<PointPath> path = points_to(node);
    if (!path) return fail(path);
    EstimatedCell cell = alone([&] { return estimate_cell(frame_.opened.tree, node, *path, frame_.meaning); });
    return orient(node, cell);
  };
  return fronts_.get(node, find, [](const Fronts& fronts) { return fronts.bytes(); });
}

Result<std::shared_ptr<const Fronts>> TreeBlocks::orient(uint32_t node, EstimatedCell& cell) const {
  const NodeTree& tree = frame_.opened.tree;
  if (node == 0 || !frame_.fronts) return frame_.fronts;  // estimate_cell has turned those of the root
  uint32_t ancestor = node;
  for (int step = 0; step < kFrontsAbove && ancestor != 0; ++step) ancestor = tree.nodes[ancestor].parent;
  const Result<std::shared_ptr<const Fronts>> above = fronts_of(ancestor);
  if (!above) return fail(above);
  return std::make_shared<const Fronts>(turn_outwards(cell.neighbourhoods, cell.codes, **above, cell.cloud));
}

Result<std::shared_ptr<const TreeBlocks::Blocks>> TreeBlocks::make(uint32_t node) const {
  // What was not announced is requested at once, not one after another.
  announce(frame_.table.of_node[node]);
  const Result<PointPath> path = points_to(node);
  if (!path) return fail(path);
  const NodeTree& tree = frame_.opened.tree;
  EstimatedCell cell = alone([&] { return estimate_cell(tree, node, *path, frame_.meaning); });
  const Result<std::shared_ptr<const Fronts>> fronts = orient(node, cell);
  if (!fronts) return fail(fronts);
  if (*fronts && node != 0 && !tree.nodes[node].leaf()) fronts_.put(node, *fronts, (**fronts).bytes());
  return alone([&] {
           CellSurfels surfels = finish_cell(tree, node, std::move(cell));
           return divide_surfels(tree, frame_.table, node, std::move(surfels), frame_.radius);
         })
      .map([this](const std::vector<MadeBlock>& made) { return take(made); });
}

Result<std::shared_ptr<const TreeBlocks::Blocks>> TreeBlocks::blocks_of(uint32_t node) const {
  return blocks_.get(
      node, [&] { return make(node); }, [](const Blocks& blocks) { return bytes_of_blocks(blocks); });
}

std::vector<surfel::ScalarAttribute> TreeBlocks::scalars_of(const model::DecodedBlock& block,
                                                            model::WantedScalars wanted) const {
  std::vector<surfel::ScalarAttribute> scalars;
  for (size_t i = 0; i < columns_.size(); ++i) {
    const bool asked =
        wanted == model::WantedScalars::kAll || (wanted == model::WantedScalars::kDrawn && columns_[i].coarse);
    if (!asked) continue;
    scalars.push_back(
        block.size() > 0
            ? block.scalars[i]
            : surfel::ScalarAttribute{columns_[i].name, scan::empty_values(frame_.meaning.schema.scalars[i].type)});
  }
  return scalars;
}

Result<model::StoredBlock> TreeBlocks::stored(size_t /*block*/) const {
  return fail(ErrorKind::kUnsupported, "is made of points: it has no bytes");
}

Result<model::DecodedBlock> TreeBlocks::decode(size_t block, model::WantedScalars scalars) const {
  SURFCAST_EXPECTS(block < frame_.table.plans.size());
  const auto number = static_cast<uint32_t>(block);
  const BlockPlan& plan = frame_.table.plans[number];
  // A block that stands for others has at most the attributes that have a meaning there.
  const bool all = scalars == model::WantedScalars::kAll;
  const model::WantedScalars wanted = all && !plan.leaf ? model::WantedScalars::kDrawn : scalars;
  if (keeper_ && !blocks_.has(plan.node)) {
    if (std::optional<model::DecodedBlock> kept = keeper_->find(number, wanted)) {
      kept->scalars = scalars_of(*kept, wanted);
      return std::move(*kept);
    }
  }
  const Result<std::shared_ptr<const Blocks>> blocks = blocks_of(plan.node);
  if (!blocks) return fail(blocks);
  const std::vector<uint32_t>& numbers = frame_.table.of_node[plan.node];
  const model::DecodedBlock& made =
      (**blocks)[static_cast<size_t>(std::ranges::lower_bound(numbers, number) - numbers.begin())];
  model::DecodedBlock copy = without_scalars(made);
  copy.scalars = scalars_of(made, wanted);
  return copy;
}

}  // namespace surfcast::point_tree
