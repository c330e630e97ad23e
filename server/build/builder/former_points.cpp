#include "builder/former_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "ldc/cell_codes.h"
#include "model/block_cloud.h"
#include "model/block_decoder.h"
#include "model/block_fields.h"
#include "scan/merge_schemas.h"
#include "surfel/drawn_radius.h"

namespace surfcast::builder {
namespace {

constexpr const char* kFormerRadius = "surfcast_former_radius";    ///< 0: to be estimated
constexpr const char* kFormerScatter = "surfcast_former_scatter";  ///< as SurfelCloud::scatter

/// True of the lattices that blocks get without one of their source (ldc::choose_lattice).
bool follows_from_radii(const surfel::Grid& grid) {
  int exponent = 0;
  return grid.offset == glm::dvec3(0) && grid.scale == glm::dvec3(grid.scale.x) &&
         std::frexp(grid.scale.x, &exponent) == 0.5;
}

std::optional<surfel::Grid> source_grid(const surfel::Grid& grid) {
  return follows_from_radii(grid) ? std::nullopt : std::optional(grid);
}

template <typename T>
std::vector<T> take_column(surfel::SurfelCloud& cloud) {
  std::vector<T> values = std::get<std::vector<T>>(std::move(cloud.scalars.back().values));
  cloud.scalars.pop_back();
  return values;
}

std::vector<uint32_t> all_of(size_t count) {
  std::vector<uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// The children of a cell in which the surfels lie. Positions were rounded when they were stored.
std::array<std::vector<uint32_t>, 8> by_octant(const surfel::SurfelCloud& cloud, const ldc::OctreeKey& cell,
                                               const geometry::RootCube& root) {
  std::array<std::vector<uint32_t>, 8> octants;
  for (uint32_t i = 0; i < cloud.size(); ++i) {
    const uint64_t code = ldc::nearest_code(cell, geometry::morton_code(root, cloud.positions[i]));
    octants.at(ldc::octant_of_code(code, cell.depth)).push_back(i);
  }
  return octants;
}

}  // namespace

Result<FormerModel> former_model(const model::ModelFile& model, std::span<const uint32_t> leaves) {
  FormerModel former;
  for (const uint32_t leaf : leaves) {
    const Result<model::StoredBlock> stored = model.stored(leaf);
    if (!stored) return fail(stored);
    const auto flags = model::BlockFlags::of_byte(static_cast<uint8_t>(stored->bytes.front()));
    former.stated_normals = former.stated_normals || flags.source_normals;
    former.stated_radii = former.stated_radii || flags.source_radii;
    const std::optional<surfel::Grid> grid = source_grid(stored->grid);
    if (std::ranges::find(former.lattices, grid, &InputName::grid) == former.lattices.end()) {
      former.lattices.push_back({model.path().filename().string(), grid});
    }
  }
  return former;
}

size_t lattice_of(const surfel::Grid& grid, const FormerModel& former) {
  const auto found = std::ranges::find(former.lattices, source_grid(grid), &InputName::grid);
  return static_cast<size_t>(found - former.lattices.begin());
}

scan::ScanSchema schema_of_points(const model::ModelFile& model) {
  scan::ScanSchema schema;
  schema.name = model.path().filename().string();
  schema.normals = true;
  schema.color_bits = model.info().color_bits;
  schema.z_up = model.info().z_up;
  for (const model::ScalarColumn& scalar : model.scalars()) {
    schema.scalars.push_back({scalar.name, static_cast<scan::ScalarType>(scalar.type)});
  }
  return schema;
}

void add_former_columns(scan::ScanSchema& schema) {
  schema.scalars.push_back({kFormerRadius, scan::ScalarType::kFloat32});
  schema.scalars.push_back({kFormerScatter, scan::ScalarType::kUint8});
}

void restore_former(surfel::SurfelCloud& cloud) {
  const std::vector<uint8_t> scatter = take_column<uint8_t>(cloud);
  const std::vector<float> radii = take_column<float>(cloud);
  if (std::ranges::count(scatter, uint8_t{1}) > 0) cloud.scatter.resize(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (radii[i] == 0) continue;
    cloud.radii[i] = radii[i];
    if (!cloud.scatter.empty()) cloud.scatter[i] = scatter[i];
  }
}

scan::ScanPoints points_of_leaf(model::DecodedBlock block, int color_bits, const FormerModel& former,
                                const scan::ScanSchema& schema,
                                const std::function<bool(const glm::dvec3& position, float radius)>& is_affected) {
  scan::ScanPoints points;
  std::vector<float> radii(block.size());
  std::vector<uint8_t> scatter(block.size());
  for (size_t i = 0; i < block.size(); ++i) {
    points.positions.push_back(block.position(i));
    const bool affected = is_affected(points.positions.back(), block.radii[i]);
    const bool estimates_normal = affected && !former.stated_normals;
    points.normals.push_back(estimates_normal ? glm::vec3(std::numeric_limits<float>::quiet_NaN()) : block.normals[i]);
    if (affected && !former.stated_radii) continue;
    radii[i] = block.radii[i];
    scatter[i] = block.is_scatter(i) ? 1 : 0;
  }
  if (color_bits != 0) points.colors = surfel::ColorAttribute{color_bits, std::move(block.colors)};
  points.scalars = std::move(block.scalars);
  points.scalars.push_back({kFormerRadius, std::move(radii)});
  points.scalars.push_back({kFormerScatter, std::move(scatter)});
  return scan::conform(std::move(points), schema);
}

model::AttributeStatistics statistics_of(model::DecodedBlock block, const model::ModelInfo& info) {
  const surfel::SurfelCloud cloud = model::cloud_of(std::move(block), info);
  return {cloud, all_of(cloud.size())};
}

std::vector<ldc::FrontCell> front_of_kept(model::DecodedBlock block, const model::ModelFile& model, bool leaf,
                                          const ldc::OctreeKey& key, const std::optional<ldc::OctreeKey>& parent,
                                          const geometry::RootCube& root, uint32_t number) {
  const surfel::SurfelCloud cloud = model::cloud_of(std::move(block), model.info());
  if (!leaf) {
    constexpr float kAnyRadius = std::numeric_limits<float>::max();
    return {{key, {number}, ldc::sample_surfels(cloud, all_of(cloud.size()), kAnyRadius)}};
  }
  const float largest = surfel::largest_drawn_radius(cloud.radii, cloud.scatter);
  if (!parent || key.depth > parent->depth) {
    return {{key, {number}, ldc::sample_surfels(cloud, all_of(cloud.size()), largest)}};
  }
  std::vector<ldc::FrontCell> cells;  // leaves of the parent that share the block
  const std::array<std::vector<uint32_t>, 8> octants = by_octant(cloud, *parent, root);
  for (uint32_t octant = 0; octant < octants.size(); ++octant) {
    const std::vector<uint32_t>& members = octants.at(octant);
    if (members.empty()) continue;
    cells.push_back({parent->child(octant), {number}, ldc::sample_surfels(cloud, members, largest)});
  }
  return cells;
}

}  // namespace surfcast::builder
