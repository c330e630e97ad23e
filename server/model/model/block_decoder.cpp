#include "model/block_decoder.h"

#include <algorithm>
#include <utility>

#include "model/block_fields.h"
#include "model/field.h"
#include "model/item_lattice.h"
#include "model/quantize.h"
#include "model/scalar_bits.h"
#include "surfel/curvature.h"

namespace surfcast::model {
namespace {

/// False if a value exceeds the limits of the shape. Such values would reach the renderer as arbitrary numbers.
bool in_range(const std::vector<Field>& fields, const FieldLayout& layout, const Precision& codes,
              const BlockShape& shape) {
  if (!within_extent(fields[kPositionField], shape.extent)) return false;
  if (!all_at_most(fields[kNormalField], codes.max_normal_code())) return false;
  if (!all_at_most(fields[kRadiusField][0], codes.max_radius_code()) ||
      !all_at_most(fields[kWeightField][0], kMaxWeightCode)) {
    return false;
  }
  const uint64_t brightest = (uint64_t{1} << shape.color_bits) - 1;
  const size_t colors = shape.color_bits > 0 ? 3 : 0;
  for (size_t i = 0; i < colors; ++i) {
    if (!all_at_most(fields[kFixedFields + i][0], brightest)) return false;
  }
  if (!layout.scatter) return shape.scatter == 0;
  const Column& scatter = fields[layout.scatter_field()][0];
  return all_at_most(scatter, 1) && shape.scatter > 0 &&
         std::count(scatter.begin(), scatter.end(), 1) == std::ptrdiff_t{shape.scatter};
}

void read_positions(const Field& field, DecodedBlock& block) {
  for (size_t i = 0; i < block.indices.size(); ++i) {
    block.indices[i] = {static_cast<int>(field[0][i]), static_cast<int>(field[1][i]), static_cast<int>(field[2][i])};
  }
}

void read_surfaces(const std::vector<Field>& fields, const Precision& codes, DecodedBlock& block) {
  const Field& normals = fields[kNormalField];
  const Column& radii = fields[kRadiusField][0];
  const Column& weights = fields[kWeightField][0];
  for (size_t i = 0; i < block.size(); ++i) {
    block.normals[i] = decode_normal(glm::u16vec2(normals[0][i], normals[1][i]), codes.octahedral_half);
    block.radii[i] = decode_logarithm(static_cast<uint32_t>(radii[i]), codes.radius_steps);
    block.weights[i] = decode_logarithm(static_cast<uint32_t>(weights[i]), kWeightSteps);
  }
}

void read_colors(std::span<const Field> fields, int bits, DecodedBlock& block) {
  block.colors.resize(block.size());
  for (size_t i = 0; i < block.size(); ++i) {
    const uint64_t green = fields[0][0][i];
    block.colors[i] = glm::u16vec3(color_from_difference(fields[1][0][i], green, bits), green,
                                   color_from_difference(fields[2][0][i], green, bits));
  }
}

template <size_t... I>
surfel::ScalarValues empty_values(ScalarCode type, std::index_sequence<I...> /*types*/) {
  surfel::ScalarValues values;
  ((type == I ? void(values.emplace<I>()) : void()), ...);
  return values;
}

surfel::ScalarAttribute read_scalar(const ScalarColumn& attribute, const Column& column) {
  surfel::ScalarAttribute scalar{
      attribute.name,
      empty_values(attribute.type, std::make_index_sequence<std::variant_size_v<surfel::ScalarValues>>())};
  std::visit(
      [&](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        values.reserve(column.size());
        for (const uint64_t bits : column) values.push_back(from_ordered_bits<T>(static_cast<BitsOf<T>>(bits)));
      },
      scalar.values);
  return scalar;
}

}  // namespace

size_t count_of(WantedScalars wanted, std::span<const ScalarColumn> scalars) {
  if (wanted == WantedScalars::kAll) return scalars.size();
  size_t count = 0;
  for (size_t i = 0; i < scalars.size(); ++i) {
    if (surfel::is_curvature_column(scalars[i].name) || (wanted == WantedScalars::kDrawn && scalars[i].coarse))
      count = i + 1;
  }
  return count;
}

Result<DecodedBlock> decode_block(std::span<const std::byte> bytes, const BlockShape& shape, size_t scalars) {
  if (bytes.empty()) return fail(ErrorKind::kInvalidInput, "cut off");
  const BlockFlags flags = BlockFlags::of_byte(static_cast<uint8_t>(bytes.front()));
  const Precision codes = flags.codes();
  const FieldLayout layout{shape.color_bits > 0, flags.scatter};
  const std::vector<size_t> columns = layout.columns(shape.scalars.size());
  const Result<std::vector<Field>> fields =
      decode_fields(bytes.subspan(1), columns, shape.surfels, layout.first_scalar() + scalars);
  if (!fields) return fail(fields);
  if (!in_range(*fields, layout, codes, shape)) return fail(ErrorKind::kInvalidInput, "values out of range");

  DecodedBlock block;
  block.grid = shape.grid;
  block.origin = shape.origin;
  block.indices.resize(shape.surfels);
  block.normals.resize(shape.surfels);
  block.radii.resize(shape.surfels);
  block.weights.resize(shape.surfels);
  read_positions((*fields)[kPositionField], block);
  read_surfaces(*fields, codes, block);
  if (layout.scatter) {
    const Column& scatter = (*fields)[layout.scatter_field()][0];
    block.scatter.assign(scatter.begin(), scatter.end());
  }
  if (layout.colored) read_colors(std::span(*fields).subspan(kFixedFields, 3), shape.color_bits, block);
  for (size_t i = 0; i < scalars; ++i) {
    block.scalars.push_back(read_scalar(shape.scalars[i], (*fields)[layout.first_scalar() + i][0]));
  }
  return block;
}

}  // namespace surfcast::model
