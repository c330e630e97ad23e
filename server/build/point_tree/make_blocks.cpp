#include "point_tree/make_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "estimation/clean_points.h"
#include "estimation/make_surfels.h"
#include "geometry/morton.h"
#include "geometry/zone.h"
#include "ldc/lattice.h"
#include "point_tree/coarse_colors.h"
#include "point_tree/coarse_planes.h"
#include "point_tree/columns.h"
#include "surfel/even_sampling.h"
#include "surfel/normalization_weights.h"

namespace surfcast::point_tree {
namespace {

/// Of the side of a cell: the width of the halo, in which neighbours are looked for. It is eight times the spacing of
/// the node and four times that of its parent, more than the 32 nearest neighbours need.
constexpr double kHalo = 1.0 / 16;

/// Rows of a node.
using Rows = std::vector<uint32_t>;

/// The rows of a node in a cell.
Rows rows_within(const NodePoints& node, const CodeRange& cell) {
  const auto first = std::ranges::lower_bound(node.codes, cell.first);
  const auto last = std::lower_bound(first, node.codes.end(), cell.last);
  Rows rows(static_cast<size_t>(last - first));
  std::iota(rows.begin(), rows.end(), static_cast<uint32_t>(first - node.codes.begin()));
  return rows;
}

/// The rows of a node in a box, but not in the cell within.
Rows rows_around(const NodePoints& node, const CodeRange& cell, const geometry::Box& box) {
  Rows rows;
  for (uint32_t row = 0; row < node.codes.size(); ++row) {
    if (!cell.contains(node.codes[row]) && geometry::contains(box, node.points.positions[row])) rows.push_back(row);
  }
  return rows;
}

/// The points of a path in a cell, along the Morton order; equal ones by the depth of their nodes.
EstimatedCell points_within(const PointPath& path, const CodeRange& range) {
  EstimatedCell unsorted{empty_like<surfel::SurfelCloud>(path.front()->points), {}, {}};
  for (const std::shared_ptr<const NodePoints>& node : path) {
    const Rows rows = rows_within(*node, range);
    append_points(node->points, rows, unsorted.cloud);
    for (const uint32_t row : rows) unsorted.codes.push_back(node->codes[row]);
  }
  Rows order(unsorted.codes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](uint32_t i) { return unsorted.codes[i]; });
  EstimatedCell sorted{empty_like<surfel::SurfelCloud>(unsorted.cloud), {}, {}};
  append_points(unsorted.cloud, order, sorted.cloud);
  append_rows(unsorted.codes, order, sorted.codes);
  return sorted;
}

void drop_duplicates(EstimatedCell& cell) {
  if (std::ranges::adjacent_find(cell.codes) == cell.codes.end()) return;
  std::vector<bool> keep = estimation::find_duplicates(cell.cloud);
  keep.flip();
  estimation::keep_surfels(cell.cloud, keep);
  size_t kept = 0;
  for (size_t i = 0; i < cell.codes.size(); ++i) {
    if (keep[i]) cell.codes[kept++] = cell.codes[i];
  }
  cell.codes.resize(kept);
}

/// The relation of a cell with its halo to itself: it is all that there is.
estimation::PartFrame frame_of(const surfel::SurfelCloud& cloud, const Cells& cells, const ldc::OctreeKey& key) {
  estimation::PartFrame frame;
  frame.bounds = cloud.bounds();
  const geometry::Box own = cells.box_of(key);
  frame.place = [own](const glm::dvec3& point) { return estimation::SitePlace{geometry::contains(own, point), false}; };
  frame.sensors = {std::nullopt};
  frame.surface_steps = {std::nullopt};
  frame.inputs = {0};
  frame.radii = estimation::RadiusPolicy::kEstimate;
  frame.points = cloud.size();
  frame.keep_neighbours = true;
  return frame;
}

/// Whether a scan is of a landscape: flat, and facing the sky. Viewers are above it, and see no backs. In a room or an
/// object, some blocks would be oriented and others not: seen from behind, its walls would have holes.
bool is_landscape(const surfel::SurfelCloud& cloud) {
  constexpr double kHighest = 1.0 / 3;  // share of the width
  constexpr double kLeastUp = 0.5;      // mean of the normals
  if (!cloud.z_up) return false;
  const glm::dvec3 size = cloud.bounds().max - cloud.bounds().min;
  double up = 0, discs = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.is_scatter(i)) continue;
    up += double{cloud.normals[i].z};
    ++discs;
  }
  return size.z <= kHighest * std::max(size.x, size.y) && up > kLeastUp * discs;
}

/// Applies the signs of the root's normals. Returns whether they are reliable, and the scan is a landscape.
bool resolve_root(const estimation::PartSigns& signs, estimation::PartSurfels& root) {
  const estimation::Scene scene{root.cloud.bounds(), root.cloud.z_up, false};
  const estimation::ResolvedSigns resolved = estimation::resolve_signs({&signs, 1}, scene);
  if (resolved.oriented) estimation::apply_signs(resolved, 0, root);
  return resolved.oriented && is_landscape(root.cloud);
}

/// Sets normals and radii. Normals that are estimated may point to either side, but for those of the root.
estimation::Neighbourhoods estimate_surfels(const Cells& cells, const ldc::OctreeKey& key,
                                            const scan::ScanSchema& schema, surfel::SurfelCloud& cloud) {
  cloud.sources = {{schema.name, 0, cloud.size(), schema.grid}};
  estimation::PartFrame frame = frame_of(cloud, cells, key);
  frame.sides = key.depth == 0 && !schema.normals;
  estimation::PartSigns signs;
  estimation::SurfelReport report;
  estimation::PartSurfels made = estimation::make_surfels(std::move(cloud), frame, signs, report);
  const estimation::SurfaceSpacing spacing(std::move(made.samples), frame.bounds);
  estimation::RadiusDecision estimated;
  estimated.missing = made.cloud.size();
  estimation::apply_radii({&estimated, 1}, frame.inputs, made.estimates, spacing, made.cloud);
  made.cloud.oriented = schema.normals || (frame.sides && resolve_root(signs, made));
  cloud = std::move(made.cloud);
  cloud.estimated_normals = !schema.normals;
  cloud.estimated_radii = true;
  return std::move(*made.neighbourhoods);
}

/// Leaves the first surfels.
void cut(surfel::SurfelCloud& cloud, size_t count) {
  std::vector<bool> keep(cloud.size(), false);
  std::fill_n(keep.begin(), count, true);
  estimation::keep_surfels(cloud, keep);
}

/// Weighs the surfels among all, and leaves the first.
void weigh_and_cut(surfel::SurfelCloud& cloud, size_t count) {
  cloud.weights = surfel::normalization_weights(cloud);
  cut(cloud, count);
}

/// The surfels of a level that is a sample as they stand for finer ones.
surfel::SurfelCloud coarse_surfels(const estimation::Neighbourhoods& neighbourhoods, const surfel::SurfelCloud& cloud) {
  surfel::SurfelCloud coarse = cloud;
  adopt_planes(neighbourhoods, coarse);
  if (coarse.colors) coarse.colors->values = coarse_colors(neighbourhoods, coarse);
  return coarse;
}

/// Whether leaves have some of the surfels: all those of a leaf, and those in octants without a child.
bool have_leaves(const Node& node, std::span<const uint64_t> codes) {
  return node.leaf() || std::ranges::any_of(codes, [&](uint64_t code) {
           return node.children[ldc::octant_of_code(code, node.key.depth)] == Node::kNone;
         });
}

std::shared_ptr<const surfel::SurfelCloud> with_radii_up_to(float largest, surfel::SurfelCloud cloud) {
  for (float& radius : cloud.radii) radius = std::min(radius, largest);
  return std::make_shared<const surfel::SurfelCloud>(std::move(cloud));
}

/// The surfels that a plan takes, before they are thinned or divided.
std::vector<uint32_t> members_of(const NodeTree& tree, const BlockPlan& plan, std::span<const uint64_t> codes) {
  const Node& node = tree.nodes[plan.node];
  std::vector<uint32_t> members;
  for (uint32_t i = 0; i < codes.size(); ++i) {
    const uint32_t octant = ldc::octant_of_code(codes[i], node.key.depth);
    const bool in_child = node.children[octant] != Node::kNone;
    const bool taken = plan.share == Share::kCell || (plan.share == Share::kOctant && octant == plan.octant) ||
                       (plan.share == Share::kRest && !in_child);
    if (taken) members.push_back(i);
  }
  return members;
}

/// A block with `count` of its surfels, evenly along their order, and larger.
MadeBlock thinned(const MadeBlock& block, size_t count, float largest) {
  const auto factor =
      static_cast<float>(std::sqrt(static_cast<double>(block.members.size()) / static_cast<double>(count)));
  auto cloud = std::make_shared<surfel::SurfelCloud>(*block.cloud);
  MadeBlock fewer{block.block, cloud, {}, {}};
  fewer.members.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const uint32_t member = block.members[i * block.members.size() / count];
    cloud->radii[member] = std::min(cloud->radii[member] * factor, largest);
    fewer.members.push_back(member);
  }
  return fewer;
}

std::vector<uint32_t> part_of(const std::vector<uint32_t>& members, const BlockPlan& plan) {
  const size_t each = (members.size() + plan.parts - 1) / plan.parts;
  const size_t first = std::min(members.size(), each * plan.part);
  const size_t last = std::min(members.size(), first + each);
  return {members.begin() + static_cast<std::ptrdiff_t>(first), members.begin() + static_cast<std::ptrdiff_t>(last)};
}

/// The lattice of the positions of a block: that of the file, unless the block is too large for it.
surfel::Grid grid_of(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members) {
  geometry::Box box;
  for (const uint32_t member : members) box.include(cloud.positions[member]);
  surfel::Grid grid = cloud.sources.front().grid.value_or(
      ldc::choose_lattice(box, double{cloud.radii[members.front()]} / ldc::kRadiusOverError));
  constexpr size_t kFew = 1;  // as for blocks of few surfels: no compact vertex is needed
  while (!ldc::indices_fit(grid, box, kFew)) grid.scale *= 2.0;
  return grid;
}

}  // namespace

EstimatedCell estimate_cell(const NodeTree& tree, uint32_t node, const PointPath& path,
                            const scan::TableMeaning& meaning) {
  const Cells& cells = tree.cells;
  const ldc::OctreeKey& key = tree.nodes[node].key;
  const scan::ScanSchema& schema = meaning.schema;
  const CodeRange range(key);
  EstimatedCell cell = points_within(path, range);
  if (cell.codes.empty()) return cell;
  cell.cloud.sources = {{schema.name, 0, cell.cloud.size(), schema.grid}};
  drop_duplicates(cell);
  geometry::Box around = cells.box_of(key);
  const double halo = kHalo * cells.side_of(key.depth);
  around.min -= halo;
  around.max += halo;
  for (const std::shared_ptr<const NodePoints>& step : path) {
    append_points(step->points, rows_around(*step, range, around), cell.cloud);
  }
  cell.neighbourhoods = estimate_surfels(cells, key, schema, cell.cloud);
  return cell;
}

CellSurfels finish_cell(const NodeTree& tree, uint32_t node, EstimatedCell estimated) {
  CellSurfels cell{std::move(estimated.cloud), std::move(estimated.codes), {}};
  const size_t count = cell.codes.size();
  if (count == 0) return cell;
  if (!tree.nodes[node].leaf()) {
    cell.coarse = coarse_surfels(estimated.neighbourhoods, cell.cloud);
    weigh_and_cut(*cell.coarse, count);
  }
  if (have_leaves(tree.nodes[node], cell.codes)) {
    weigh_and_cut(cell.cloud, count);
  } else {
    cut(cell.cloud, count);
  }
  return cell;
}

Result<std::vector<MadeBlock>> divide_surfels(const NodeTree& tree, const BlockTable& table, uint32_t node,
                                              CellSurfels surfels, double radius) {
  const auto largest = static_cast<float>(largest_radius(tree, node, radius));
  const std::shared_ptr<const surfel::SurfelCloud> cloud = with_radii_up_to(largest, std::move(surfels.cloud));
  const std::shared_ptr<const surfel::SurfelCloud> coarse =
      surfels.coarse ? with_radii_up_to(largest, std::move(*surfels.coarse)) : cloud;
  std::vector<MadeBlock> blocks;
  for (const uint32_t number : table.of_node[node]) {
    const BlockPlan& plan = table.plans[number];
    const size_t room = table.entries[number].items;
    MadeBlock block{number, plan.leaf ? cloud : coarse, members_of(tree, plan, surfels.codes), {}};
    if (plan.leaf) block.members = part_of(block.members, plan);
    if (block.members.size() > room && plan.leaf) {
      return fail(ErrorKind::kUnsupported,
                  "node " + tree.name_of(node) +
                      " has more points of the levels above than octrees of points have: build a model of the scan");
    }
    if (block.members.size() > room) block = thinned(block, room, largest);
    if (!block.members.empty()) block.grid = grid_of(*cloud, block.members);
    blocks.push_back(std::move(block));
  }
  return blocks;
}

RootFacts measure_root(const NodeTree& tree, const CellSurfels& root) {
  std::vector<float> radii;
  for (size_t i = 0; i < root.cloud.size(); ++i) {
    if (!root.cloud.is_scatter(i)) radii.push_back(root.cloud.radii[i]);
  }
  RootFacts facts{surfel::kRadiusOverSpacing * tree.spacing, 0};
  facts.scatter = 1 - static_cast<double>(radii.size()) / static_cast<double>(root.cloud.size());
  if (radii.empty()) return facts;
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::ranges::nth_element(radii, middle);
  facts.radius = double{*middle};
  return facts;
}

}  // namespace surfcast::point_tree
