#include "point_tree/open_in_place.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "crs/coordinate_system.h"
#include "geometry/zone.h"
#include "model/elevation_range.h"
#include "model/statistics.h"
#include "point_tree/make_blocks.h"
#include "point_tree/tree_blocks.h"
#include "point_tree/tree_formats.h"

namespace surfcast::point_tree {
namespace {

/// The system of the points. Degrees and other units along the axes cannot be drawn as they are.
Result<model::Georeference> find_system(const std::string& stated) {
  if (stated.empty()) return model::Georeference();
  const Result<crs::CoordinateSystem> system = crs::read_system(stated);
  if (!system) return model::Georeference();  // as in a build: what makes no sense is ignored
  if (!system->is_metric()) {
    return fail(ErrorKind::kUnsupported,
                "its coordinates are those of " + system->name + ", which a build transforms: build a model of it");
  }
  return model::Georeference{{system->name, system->id, system->wkt}, {}};
}

/// Ranges and classes of the points of the root, which stand for all.
void add_statistics(const NodePoints& root, uint64_t points, model::ModelInfo& info) {
  surfel::SurfelCloud cloud;
  cloud.positions = root.points.positions;
  cloud.scalars = root.points.scalars;
  std::vector<uint32_t> all(cloud.size());
  std::iota(all.begin(), all.end(), 0U);
  const model::AttributeStatistics statistics(cloud, all);
  info.ranges = statistics.ranges(info.scalar_names);
  info.classes = statistics.classes();
  const double factor = static_cast<double>(points) / static_cast<double>(std::max<size_t>(1, cloud.size()));
  for (model::ClassCount& count : info.classes) {
    count.surfels = static_cast<uint64_t>(std::llround(factor * static_cast<double>(count.surfels)));
  }
}

model::ModelInfo describe_tree(const TreeFrame& frame, const NodePoints& root, const std::string& name,
                               double scatter) {
  model::ModelInfo info;
  const scan::ScanSchema& schema = frame.meaning.schema;
  info.in_place = true;
  info.surfels = frame.opened.tree.points();
  // Blocks with scatter are drawn by other programs than blocks without: there may be some beyond the root.
  info.scatter = std::max<uint64_t>(1, static_cast<uint64_t>(scatter * static_cast<double>(info.surfels)));
  info.kinds = {{std::string(model::kSurfelKind), static_cast<uint32_t>(frame.table.entries.size()), info.surfels}};
  info.oriented = schema.normals;
  info.partly_oriented = info.oriented || frame.fronts;
  info.z_up = schema.z_up;
  info.color_bits = schema.color_bits;
  for (const scan::ScalarField& field : schema.scalars) info.scalar_names.push_back(field.name);
  info.source_names = {std::filesystem::path(name).filename().string()};
  info.bounds = frame.opened.bounds;
  std::vector<int> heights(frame.table.entries.size());
  for (size_t i = heights.size(); i-- > 0;) {
    const uint32_t parent = frame.table.entries[i].parent;
    info.levels = std::max(info.levels, heights[i] + 1);
    if (parent != ldc::BlockEntry::kNoParent) heights[parent] = std::max(heights[parent], heights[i] + 1);
  }
  const int up = info.z_up ? 2 : 1;
  std::vector<model::ElevationSlab> slabs;
  for (const glm::dvec3& p : root.points.positions) slabs.push_back({{p[up], p[up]}, 1});
  info.elevation = model::elevation_range(slabs);
  add_statistics(root, info.surfels, info);
  return info;
}

/// Of all points: as stated, if that holds for the points of the root. Else those of the cube.
geometry::Box bounds_of(const geometry::Box& stated, const NodePoints& root, const Cells& cells) {
  constexpr double kRounding = 1e-6;  // of the side: bounds are written with fewer digits
  const double margin = kRounding * cells.side;
  const geometry::Box wide{stated.min - margin, stated.max + margin};
  const bool holds = !stated.empty() && std::ranges::all_of(root.points.positions, [&](const glm::dvec3& point) {
    return geometry::contains(wide, point);
  });
  return holds ? wide : cells.box_of({});
}

Result<model::ModelFile> open_tree(OpenedTree opened, const InPlaceLimits& limits,
                                   std::shared_ptr<model::BlockCache> cache) {
  TreeFrame frame;
  frame.opened = std::move(opened);
  const NodeReader& reader = *frame.opened.reader;
  const NodeTree& tree = frame.opened.tree;
  if (tree.nodes.front().points == 0) return fail(ErrorKind::kUnsupported, "its root has no points");
  Result<model::Georeference> system = find_system(reader.traits().crs);
  if (!system) return fail(system);
  frame.georeference = std::move(*system);
  const Result<scan::PointTable> table = reader.read(tree.nodes.front());
  if (!table) return fail(table);
  Result<scan::TableMeaning> meaning = decide_meaning(reader, *table);
  if (!meaning) return fail(meaning);
  frame.meaning = std::move(*meaning);
  const std::string name = reader.source().name();
  frame.meaning.schema.name = std::filesystem::path(name).filename().string();
  Result<NodePoints> sorted = sort_points(*table, frame.meaning, tree.cells, tree.nodes.front().key);
  if (!sorted) return fail(sorted);
  const auto root = std::make_shared<const NodePoints>(std::move(*sorted));
  if (root->codes.empty()) return fail(ErrorKind::kInvalidInput, "its root has no points with coordinates");
  EstimatedCell estimated = estimate_cell(tree, 0, {root}, frame.meaning);
  if (estimated.cloud.oriented && estimated.cloud.estimated_normals) {
    frame.fronts = std::make_shared<const Fronts>(fronts_of(estimated.codes, estimated.cloud));
  }
  CellSurfels surfels = finish_cell(tree, 0, std::move(estimated));
  const RootFacts facts = measure_root(tree, surfels);
  frame.radius = facts.radius;
  frame.opened.bounds = bounds_of(frame.opened.bounds, *root, tree.cells);
  frame.table = plan_blocks(tree, frame.opened.bounds, frame.radius);
  const Result<std::vector<MadeBlock>> blocks_of_root =
      divide_surfels(tree, frame.table, 0, std::move(surfels), frame.radius);
  if (!blocks_of_root) return fail(blocks_of_root);
  model::ModelInfo info = describe_tree(frame, *root, name, facts.scatter);
  std::vector<ldc::BlockEntry> entries = frame.table.entries;
  auto blocks =
      std::make_unique<const TreeBlocks>(std::move(frame), limits.memory, std::move(cache), root, *blocks_of_root);
  return model::ModelFile::of_blocks(name, std::move(info), std::move(entries), std::move(blocks));
}

}  // namespace

std::optional<TreeFormat> tree_format_of(std::string_view path) {
  if (path.ends_with(".copc.laz")) return TreeFormat::kCopc;
  if (path == "ept.json" || path.ends_with("/ept.json")) return TreeFormat::kEpt;
  if (path == "metadata.json" || path.ends_with("/metadata.json")) return TreeFormat::kPotree2;
  return std::nullopt;
}

namespace {

Result<OpenedTree> open_format(TreeFormat format, std::unique_ptr<const ByteSource> file,
                               std::unique_ptr<const FileFolder> folder, uint64_t most_bytes) {
  switch (format) {
    case TreeFormat::kCopc:
      return open_copc(std::move(file), most_bytes);
    case TreeFormat::kEpt:
      return open_ept(std::move(file), std::move(folder), most_bytes);
    case TreeFormat::kPotree2:
      break;
  }
  return open_potree(std::move(file), most_bytes);
}

}  // namespace

Result<model::ModelFile> open_in_place(TreeFormat format, std::unique_ptr<const ByteSource> file,
                                       std::unique_ptr<const FileFolder> folder, const InPlaceLimits& limits,
                                       std::shared_ptr<model::BlockCache> cache) {
  const std::string name = file->name();
  return open_format(format, std::move(file), std::move(folder), limits.hierarchy_bytes)
      .and_then([&](OpenedTree opened) { return open_tree(std::move(opened), limits, std::move(cache)); })
      .map_error([&](const Error& error) {
        return Error{error.kind, name + ": " + error.message};
      });
}

}  // namespace surfcast::point_tree
