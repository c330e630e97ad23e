#include "model/block_encoder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/contract.h"
#include "model/block_fields.h"
#include "model/field.h"
#include "model/path_order.h"
#include "model/quantize.h"
#include "model/scalar_bits.h"
#include "surfel/curvature.h"

namespace surfcast::model {
namespace {

using Members = std::span<const uint32_t>;

template <typename Value>
Column make_column(Members members, Value value) {
  Column column;
  column.reserve(members.size());
  for (const uint32_t surfel : members) column.push_back(value(surfel));
  return column;
}

/// Lattice indices of the members, relative to the lowest one, which becomes the block's origin.
std::vector<glm::ivec3> make_indices(const surfel::SurfelCloud& cloud, Members members, const surfel::Grid& grid,
                                     EncodedBlock& block) {
  std::vector<glm::i64vec3> absolute;
  absolute.reserve(members.size());
  for (const uint32_t surfel : members) absolute.push_back(grid.index(cloud.positions[surfel]));
  glm::i64vec3 lowest = absolute.front();
  glm::i64vec3 highest = absolute.front();
  for (const glm::i64vec3& index : absolute) {
    lowest = glm::min(lowest, index);
    highest = glm::max(highest, index);
  }
  block.origin = lowest;
  block.extent = glm::u32vec3(highest - lowest);
  std::vector<glm::ivec3> indices;
  indices.reserve(members.size());
  for (const glm::i64vec3& index : absolute) indices.emplace_back(index - lowest);
  return indices;
}

Field position_field(std::span<const glm::ivec3> indices, std::span<const uint32_t> path) {
  Field field(3);
  for (int axis = 0; axis < 3; ++axis) {
    field[axis] = make_column(path, [&](uint32_t i) { return static_cast<uint64_t>(indices[i][axis]); });
  }
  return field;
}

/// The cone of the decoded normals, widened by what curved surfels turn within their reach.
std::optional<geometry::NormalCone> cone_of(const surfel::SurfelCloud& cloud, Members members,
                                            std::span<const glm::vec3> decoded) {
  constexpr double kReach = 1.1;  // of a kernel, in radii
  std::optional<geometry::NormalCone> cone = geometry::normal_cone(decoded);
  const surfel::CurvatureColumns columns(cloud.scalars);
  if (!cone || columns.empty()) return cone;
  double bend = 0;
  for (const uint32_t s : members) bend = std::max(bend, surfel::decode_curvature(columns.at(s), 1).largest());
  const double half = double{cone->half_angle} + std::asin(std::min(1.0, kReach * bend));
  if (half >= std::numbers::pi) return std::nullopt;
  cone->half_angle = static_cast<float>(half);
  return cone;
}

Field normal_field(const surfel::SurfelCloud& cloud, Members members, int octahedral_half, EncodedBlock& block) {
  Field field(2);
  std::vector<glm::vec3> decoded;
  for (const uint32_t surfel : members) {
    const glm::u16vec2 code = encode_normal(cloud.normals[surfel], octahedral_half);
    field[0].push_back(code.x);
    field[1].push_back(code.y);
    decoded.push_back(decode_normal(code, octahedral_half));
  }
  if (cloud.oriented && block.scatter == 0) block.normals = cone_of(cloud, members, decoded);
  return field;
}

Field radius_field(const surfel::SurfelCloud& cloud, Members members, int steps, EncodedBlock& block) {
  Column codes = make_column(members, [&](uint32_t s) { return encode_logarithm(cloud.radii[s], steps); });
  // Splats of scatter are smaller than its spacing.
  const bool discs_alone = block.scatter > 0 && block.scatter < members.size();
  Column sorted;
  for (size_t i = 0; i < members.size(); ++i) {
    if (!discs_alone || !cloud.is_scatter(members[i])) sorted.push_back(codes[i]);
  }
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  block.spacing = decode_logarithm(static_cast<uint32_t>(*middle), steps);
  block.max_radius = decode_logarithm(static_cast<uint32_t>(*std::max_element(codes.begin(), codes.end())), steps);
  return {std::move(codes)};
}

Field scatter_field(const surfel::SurfelCloud& cloud, Members members) {
  return {make_column(members, [&](uint32_t s) { return cloud.scatter[s]; })};
}

void append_colors(const surfel::ColorAttribute& colors, Members members, std::vector<Field>& fields) {
  const auto& values = colors.values;
  fields.push_back({make_column(members, [&](uint32_t s) { return values[s].y; })});
  for (const int channel : {0, 2}) {
    fields.push_back({make_column(
        members, [&](uint32_t s) { return color_difference(values[s][channel], values[s].y, colors.bits); })});
  }
}

Field scalar_field(const surfel::ScalarAttribute& scalar, Members members) {
  return {std::visit(
      [&](const auto& values) { return make_column(members, [&](uint32_t s) { return to_ordered_bits(values[s]); }); },
      scalar.values)};
}

/// Members along a path on which neighbours are near each other, and their lattice indices.
struct Path {
  std::vector<uint32_t> members;
  std::vector<uint32_t> order;  ///< of `indices`
  std::vector<glm::ivec3> indices;
};

Path path_of(const surfel::SurfelCloud& cloud, Members members, const surfel::Grid& grid, EncodedBlock& block) {
  Path path;
  path.indices = make_indices(cloud, members, grid, block);
  path.order = path_order(path.indices);
  path.members.reserve(path.order.size());
  for (const uint32_t i : path.order) path.members.push_back(members[i]);
  return path;
}

uint32_t count_scatter(const surfel::SurfelCloud& cloud, Members members) {
  return static_cast<uint32_t>(
      std::count_if(members.begin(), members.end(), [&cloud](uint32_t s) { return cloud.is_scatter(s); }));
}

surfel::ScalarAttribute rows_of(const surfel::ScalarAttribute& scalar, Members members) {
  return {scalar.name, std::visit(
                           [&](const auto& values) {
                             std::decay_t<decltype(values)> rows;
                             rows.reserve(members.size());
                             for (const uint32_t s : members) rows.push_back(values[s]);
                             return surfel::ScalarValues(std::move(rows));
                           },
                           scalar.values)};
}

}  // namespace

EncodedBlock encode_block(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members,
                          const surfel::Grid& grid) {
  SURFCAST_EXPECTS(!members.empty());
  EncodedBlock block;
  block.grid = grid;
  block.items = static_cast<uint32_t>(members.size());
  block.scatter = count_scatter(cloud, members);
  const Path path = path_of(cloud, members, grid, block);
  const std::vector<uint32_t>& ordered = path.members;

  const BlockFlags flags{!cloud.estimated_normals, !cloud.estimated_radii, block.scatter > 0};
  std::vector<Field> fields;
  fields.push_back(position_field(path.indices, path.order));
  fields.push_back(normal_field(cloud, ordered, flags.codes().octahedral_half, block));
  fields.push_back(radius_field(cloud, ordered, flags.codes().radius_steps, block));
  fields.push_back(
      {make_column(ordered, [&](uint32_t s) { return encode_logarithm(cloud.weights[s], kWeightSteps); })});
  if (cloud.colors) append_colors(*cloud.colors, ordered, fields);
  if (flags.scatter) fields.push_back(scatter_field(cloud, ordered));
  for (const surfel::ScalarAttribute& scalar : cloud.scalars) fields.push_back(scalar_field(scalar, ordered));
  block.bytes = {static_cast<std::byte>(flags.byte())};
  const std::vector<std::byte> packed = encode_fields(fields);
  block.bytes.insert(block.bytes.end(), packed.begin(), packed.end());
  return block;
}

DecodedBlock quantize_block(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members,
                            const surfel::Grid& grid) {
  SURFCAST_EXPECTS(!members.empty());
  EncodedBlock place;
  const Path path = path_of(cloud, members, grid, place);
  const bool scatter = count_scatter(cloud, members) > 0;
  const Precision codes = BlockFlags{!cloud.estimated_normals, !cloud.estimated_radii, scatter}.codes();
  DecodedBlock block;
  block.grid = grid;
  block.oriented = cloud.oriented;
  block.origin = place.origin;
  for (const uint32_t i : path.order) block.indices.push_back(path.indices[i]);
  for (const uint32_t s : path.members) {
    block.normals.push_back(
        decode_normal(encode_normal(cloud.normals[s], codes.octahedral_half), codes.octahedral_half));
    block.radii.push_back(decode_logarithm(encode_logarithm(cloud.radii[s], codes.radius_steps), codes.radius_steps));
    block.weights.push_back(decode_logarithm(encode_logarithm(cloud.weights[s], kWeightSteps), kWeightSteps));
    if (scatter) block.scatter.push_back(cloud.scatter[s]);
    if (cloud.colors) block.colors.push_back(cloud.colors->values[s]);
  }
  for (const surfel::ScalarAttribute& scalar : cloud.scalars) block.scalars.push_back(rows_of(scalar, path.members));
  return block;
}

}  // namespace surfcast::model
