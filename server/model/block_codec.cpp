#include "model/block_codec.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/contract.h"
#include "model/column.h"
#include "model/quantize.h"
#include "model/scalar_bits.h"

namespace surfcast {
namespace {

/// The columns that every block has, in the order of the file; colours and scalars follow.
enum FixedColumn : size_t { kX, kY, kZ, kNormalU, kNormalV, kRadius, kWeight, kFixedColumns };

using Members = std::span<const uint32_t>;

template <typename Value>
Column make_column(Members members, Value value) {
  Column column;
  column.reserve(members.size());
  for (const uint32_t surfel : members) column.push_back(value(surfel));
  return column;
}

void append_positions(const SurfelCloud& cloud, Members members, const Grid& grid, EncodedBlock& block,
                      std::vector<Column>& columns) {
  std::vector<glm::i64vec3> indices;
  indices.reserve(members.size());
  for (const uint32_t surfel : members) indices.push_back(grid.index(cloud.positions[surfel]));
  glm::i64vec3 lowest = indices.front();
  glm::i64vec3 highest = indices.front();
  for (const glm::i64vec3& index : indices) {
    lowest = glm::min(lowest, index);
    highest = glm::max(highest, index);
  }
  block.origin = lowest;
  block.extent = glm::u32vec3(highest - lowest);
  for (int axis = 0; axis < 3; ++axis) {
    Column column;
    column.reserve(indices.size());
    for (const glm::i64vec3& index : indices) column.push_back(static_cast<uint64_t>((index - lowest)[axis]));
    columns.push_back(std::move(column));
  }
}

void append_surfaces(const SurfelCloud& cloud, Members members, EncodedBlock& block, std::vector<Column>& columns) {
  std::vector<glm::vec3> decoded;
  Column u;
  Column v;
  for (const uint32_t surfel : members) {
    const glm::u16vec2 code = encode_normal(cloud.normals[surfel]);
    u.push_back(code.x);
    v.push_back(code.y);
    decoded.push_back(decode_normal(code));
  }
  columns.push_back(std::move(u));
  columns.push_back(std::move(v));
  if (cloud.oriented) block.normals = normal_cone(decoded);

  Column radii = make_column(members, [&](uint32_t s) { return encode_log(cloud.radii[s]); });
  Column sorted = radii;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  block.spacing = decode_log(static_cast<uint32_t>(*middle));
  block.max_radius = decode_log(static_cast<uint32_t>(*std::max_element(middle, sorted.end())));
  columns.push_back(std::move(radii));
  columns.push_back(make_column(members, [&](uint32_t s) { return encode_log(cloud.weights[s]); }));
}

void append_attributes(const SurfelCloud& cloud, Members members, std::vector<Column>& columns) {
  for (int channel = 0; cloud.colors && channel < 3; ++channel) {
    columns.push_back(make_column(members, [&](uint32_t s) { return cloud.colors->values[s][channel]; }));
  }
  for (const ScalarAttribute& scalar : cloud.scalars) {
    columns.push_back(std::visit(
        [&](const auto& values) {
          return make_column(members, [&](uint32_t s) { return to_ordered_bits(values[s]); });
        },
        scalar.values));
  }
}

bool all_at_most(const Column& column, uint64_t limit) {
  return std::all_of(column.begin(), column.end(), [limit](uint64_t value) { return value <= limit; });
}

/// Values beyond what the shape allows would reach the renderer as wild indices, so they are refused.
bool in_range(const std::vector<Column>& columns, const BlockShape& shape) {
  const std::array<uint64_t, kFixedColumns> limits{shape.extent.x,      shape.extent.y,      shape.extent.z,
                                                   2 * kOctahedralHalf, 2 * kOctahedralHalf, kMaxLogCode,
                                                   kMaxLogCode};
  for (size_t i = 0; i < kFixedColumns; ++i) {
    if (!all_at_most(columns[i], limits[i])) return false;
  }
  const uint64_t brightest = (uint64_t{1} << shape.color_bits) - 1;
  const size_t colors = shape.color_bits > 0 ? 3 : 0;
  for (size_t i = 0; i < colors; ++i) {
    if (!all_at_most(columns[kFixedColumns + i], brightest)) return false;
  }
  return true;
}

template <size_t... I>
ScalarValues empty_values(ScalarType type, std::index_sequence<I...> /*types*/) {
  ScalarValues values;
  ((type == I ? void(values.emplace<I>()) : void()), ...);
  return values;
}

ScalarAttribute read_scalar(const std::string& name, ScalarType type, const Column& column) {
  ScalarAttribute scalar{name, empty_values(type, std::make_index_sequence<std::variant_size_v<ScalarValues>>())};
  std::visit(
      [&](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        values.reserve(column.size());
        for (const uint64_t bits : column) values.push_back(from_ordered_bits<T>(static_cast<BitsOf<T>>(bits)));
      },
      scalar.values);
  return scalar;
}

void read_fixed(const std::vector<Column>& columns, DecodedBlock& block) {
  const size_t count = columns[kX].size();
  block.indices.resize(count);
  block.normals.resize(count);
  block.radii.resize(count);
  block.weights.resize(count);
  for (size_t i = 0; i < count; ++i) {
    block.indices[i] = glm::ivec3(columns[kX][i], columns[kY][i], columns[kZ][i]);
    block.normals[i] = decode_normal(glm::u16vec2(columns[kNormalU][i], columns[kNormalV][i]));
    block.radii[i] = decode_log(static_cast<uint32_t>(columns[kRadius][i]));
    block.weights[i] = decode_log(static_cast<uint32_t>(columns[kWeight][i]));
  }
}

void read_attributes(const std::vector<Column>& columns, const BlockShape& shape, DecodedBlock& block) {
  size_t next = kFixedColumns;
  if (shape.color_bits > 0) {
    block.colors.resize(columns[next].size());
    for (int channel = 0; channel < 3; ++channel, ++next) {
      for (size_t i = 0; i < block.colors.size(); ++i) {
        block.colors[i][channel] = static_cast<uint16_t>(columns[next][i]);
      }
    }
  }
  for (size_t i = 0; i < shape.scalar_names.size(); ++i) {
    block.scalars.push_back(read_scalar(shape.scalar_names[i], shape.scalar_types[i], columns[next + i]));
  }
}

}  // namespace

EncodedBlock encode_block(const SurfelCloud& cloud, std::span<const uint32_t> members, const Grid& grid) {
  SURFCAST_EXPECTS(!members.empty());
  EncodedBlock block;
  block.surfels = static_cast<uint32_t>(members.size());
  std::vector<Column> columns;
  append_positions(cloud, members, grid, block, columns);
  append_surfaces(cloud, members, block, columns);
  append_attributes(cloud, members, columns);
  block.bytes = encode_columns(columns);
  return block;
}

Result<DecodedBlock> decode_block(std::span<const std::byte> bytes, const BlockShape& shape) {
  const size_t count = kFixedColumns + (shape.color_bits > 0 ? 3 : 0) + shape.scalar_names.size();
  const Result<std::vector<Column>> columns = decode_columns(bytes, count, shape.surfels);
  if (!columns) return fail(columns.error());
  if (!in_range(*columns, shape)) return fail(ErrorKind::kInvalidInput, "values out of range");
  DecodedBlock block;
  block.grid = shape.grid;
  block.origin = shape.origin;
  read_fixed(*columns, block);
  read_attributes(*columns, shape, block);
  return block;
}

}  // namespace surfcast
