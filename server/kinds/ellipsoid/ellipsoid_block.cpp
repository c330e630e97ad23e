#include "ellipsoid/ellipsoid_block.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "base/contract.h"
#include "ellipsoid/ellipsoid_codes.h"
#include "model/byte_stream.h"
#include "model/field.h"
#include "model/item_lattice.h"
#include "model/path_order.h"
#include "model/scalar_bits.h"
#include "surfel/even_sampling.h"

namespace surfcast::ellipsoid {
namespace {

constexpr double kSemiAxisOverError = 256;
constexpr float kRadiusSlack = 1.0001F;  // codes of values and factors are rounded
constexpr uint8_t kColorsBit = 1;
constexpr uint8_t kMergedBit = 2;  ///< of a coarse block: factors, and scalars as floats

/// Fields of every block. Factors, colours and scalars follow.
enum FieldNumber { kPositions, kValues, kRotations, kFixedFields };

struct Traits {
  bool colors = false;
  bool merged = false;
  std::vector<uint8_t> scalars;  ///< types
};

double tolerance_of(const Ellipsoids& ellipsoids, double scale) {
  std::vector<double> middle;
  middle.reserve(ellipsoids.size());
  for (const glm::dvec3& values : ellipsoids.values) middle.push_back(scale * values.y);
  return model::item_tolerance(std::move(middle), kSemiAxisOverError);
}

template <typename Value>
model::Column column_of(const std::vector<uint32_t>& path, const Value& value) {
  model::Column column;
  column.reserve(path.size());
  for (const uint32_t i : path) column.push_back(static_cast<uint64_t>(value(i)));
  return column;
}

/// The largest, and how far each of the others is below the one before: descending values are small numbers so.
model::Field value_field(const Ellipsoids& ellipsoids, const std::vector<uint32_t>& path, int zero) {
  model::Field field(3);
  for (const uint32_t i : path) {
    const glm::dvec3& values = ellipsoids.values[i];
    uint32_t above = encode_value(values.x, zero);
    field[0].push_back(above);
    for (const int axis : {1, 2}) {
      const uint32_t code = std::min(above, encode_value(values[axis], zero));
      field[static_cast<size_t>(axis)].push_back(above - code);
      above = code;
    }
  }
  return field;
}

model::Field rotation_field(const Ellipsoids& ellipsoids, const std::vector<uint32_t>& path) {
  model::Field field(3);
  for (const uint32_t i : path) {
    const glm::uvec3 code = encode_rotation(canonical_rotation(ellipsoids.rotations[i]));
    for (int part = 0; part < 3; ++part) field[static_cast<size_t>(part)].push_back(code[part]);
  }
  return field;
}

model::Field scalar_field(const surfel::ScalarAttribute& scalar, const std::vector<uint32_t>& path) {
  return std::visit(
      [&](const auto& values) -> model::Field {
        return {column_of(path, [&](uint32_t i) { return model::to_ordered_bits(values[i]); })};
      },
      scalar.values);
}

std::vector<model::Field> fields_of(const Ellipsoids& ellipsoids, const std::vector<glm::ivec3>& indices,
                                    const std::vector<uint32_t>& path, const Traits& traits, int zero) {
  std::vector<model::Field> fields(kFixedFields);
  fields[kPositions] = model::vector_field(path, indices);
  fields[kValues] = value_field(ellipsoids, path, zero);
  fields[kRotations] = rotation_field(ellipsoids, path);
  if (traits.merged) {
    fields.push_back({column_of(path, [&](uint32_t i) { return encode_factor(ellipsoids.factors[i]); })});
  }
  if (traits.colors) fields.push_back(model::vector_field(path, ellipsoids.colors));
  for (const surfel::ScalarAttribute& scalar : ellipsoids.scalars) fields.push_back(scalar_field(scalar, path));
  return fields;
}

std::vector<size_t> columns_of(const Traits& traits) {
  std::vector<size_t> columns{3, 3, 3};
  if (traits.merged) columns.push_back(1);
  if (traits.colors) columns.push_back(3);
  columns.insert(columns.end(), traits.scalars.size(), 1);
  return columns;
}

tl::unexpected<Error> damaged(const char* what) {
  return fail(ErrorKind::kInvalidInput, what);
}

Status read_positions(const model::Field& field, EllipsoidBlock& block) {
  if (!model::within_extent(field, block.extent)) return damaged("positions out of range");
  for (size_t i = 0; i < field[0].size(); ++i) block.positions.emplace_back(field[0][i], field[1][i], field[2][i]);
  return {};
}

Status read_values(const model::Field& field, int zero, EllipsoidBlock& block) {
  constexpr uint64_t kMax = uint64_t{kValueOctaves} * kValueSteps + 1;
  for (size_t i = 0; i < field[0].size(); ++i) {
    const uint64_t first = field[0][i];
    const uint64_t second = first - field[1][i];
    const uint64_t third = second - field[2][i];
    // A difference below 0 wraps to a number above all codes.
    if (first == 0 || first > kMax || second > kMax || third > kMax) return damaged("values out of range");
    const auto value = [zero](uint64_t code) { return decode_value(static_cast<uint32_t>(code), zero); };
    block.values.emplace_back(value(first), value(second), value(third));
    if (!std::isnormal(block.values.back().x)) return damaged("values out of range");
  }
  return {};
}

Status read_rotations(const model::Field& field, EllipsoidBlock& block) {
  if (!model::all_at_most(field, uint64_t{2} * kRotationHalf)) return damaged("rotations out of range");
  for (size_t i = 0; i < field[0].size(); ++i) {
    block.rotations.emplace_back(decode_rotation({field[0][i], field[1][i], field[2][i]}));
  }
  return {};
}

Status read_factors(const model::Field& field, EllipsoidBlock& block) {
  if (!model::all_at_most(field[0], uint64_t{2} * kFactorOne)) return damaged("factors out of range");
  for (const uint64_t code : field[0]) block.factors.push_back(decode_factor(static_cast<uint32_t>(code)));
  return {};
}

Status read_colors(const model::Field& field, EllipsoidBlock& block) {
  if (!model::all_at_most(field, std::numeric_limits<uint8_t>::max())) return damaged("colours out of range");
  for (size_t i = 0; i < field[0].size(); ++i) block.colors.emplace_back(field[0][i], field[1][i], field[2][i]);
  return {};
}

/// The values of a column in the type with the index `type` of ScalarValues.
template <size_t kType = 0>
Result<surfel::ScalarValues> scalar_values(const model::Column& column, size_t type) {
  if constexpr (kType < std::variant_size_v<surfel::ScalarValues>) {
    if (type != kType) return scalar_values<kType + 1>(column, type);
    using Values = std::variant_alternative_t<kType, surfel::ScalarValues>;
    using Bits = model::BitsOf<typename Values::value_type>;
    if (!model::all_at_most(column, std::numeric_limits<Bits>::max())) return damaged("attribute out of range");
    Values values;
    values.reserve(column.size());
    for (const uint64_t bits : column) {
      values.push_back(model::from_ordered_bits<typename Values::value_type>(static_cast<Bits>(bits)));
    }
    return values;
  } else {
    return damaged("unknown attribute type");
  }
}

uint8_t float_type() {
  return static_cast<uint8_t>(surfel::ScalarValues(std::vector<float>()).index());
}

Status read_fields(const std::vector<model::Field>& fields, const Traits& traits, int zero,
                   const model::EllipsoidSource& source, EllipsoidBlock& block) {
  size_t at = kFixedFields;
  Status status = read_positions(fields[kPositions], block);
  if (status) status = read_values(fields[kValues], zero, block);
  if (status) status = read_rotations(fields[kRotations], block);
  if (status && traits.merged) status = read_factors(fields[at++], block);
  if (status && traits.colors) status = read_colors(fields[at++], block);
  if (!status) return status;
  if (!traits.merged) block.factors.assign(block.size(), 1.0F);
  for (size_t i = 0; i < traits.scalars.size(); ++i) {
    Result<surfel::ScalarValues> values = scalar_values(fields[at + i][0], traits.scalars[i]);
    if (!values) return fail(values);
    block.scalars.push_back({source.attributes[model::kDerivedAttributes + i].name, std::move(*values)});
  }
  return {};
}

std::vector<uint8_t> scalar_types(const model::EllipsoidSource& source, bool merged) {
  std::vector<uint8_t> types;
  for (size_t i = model::kDerivedAttributes; i < source.attributes.size(); ++i) {
    types.push_back(merged ? float_type() : source.attributes[i].type);
  }
  return types;
}

}  // namespace

model::EncodedBlock encode_ellipsoids(const Ellipsoids& ellipsoids, const model::EllipsoidSource& source,
                                      uint32_t number, bool merged) {
  SURFCAST_EXPECTS(ellipsoids.size() > 0);
  const double scale = source.scale();
  model::EncodedBlock block;
  block.kind = model::kEllipsoidKind;
  block.items = static_cast<uint32_t>(ellipsoids.size());
  block.grid = model::item_lattice(ellipsoids.positions, tolerance_of(ellipsoids, scale));
  const std::vector<glm::ivec3> indices = model::item_indices(ellipsoids.positions, block);
  const std::vector<uint32_t> path = model::path_order(indices);
  const Traits traits{!ellipsoids.colors.empty(), merged, {}};
  double largest = 0;
  double drawn = 0;
  for (size_t i = 0; i < ellipsoids.size(); ++i) {
    largest = std::max(largest, ellipsoids.values[i].x);
    drawn = std::max(drawn, scale * double{ellipsoids.factors[i]} * ellipsoids.values[i].x);
  }
  const int zero = value_zero(largest);
  const double step = source.on_grid() ? source.least_step() : model::step_along(indices, path, block.grid.scale.x);
  block.spacing = static_cast<float>(surfel::kRadiusOverSpacing * step);
  block.max_radius = std::max(block.spacing, kRadiusSlack * static_cast<float>(drawn / 2));
  model::ByteWriter writer;
  writer.put(number);
  writer.put(static_cast<uint8_t>((traits.colors ? kColorsBit : 0) | (traits.merged ? kMergedBit : 0)));
  writer.put(static_cast<int16_t>(zero));
  writer.put_bytes(model::encode_fields(fields_of(ellipsoids, indices, path, traits, zero)));
  block.bytes = std::move(writer).take();
  return block;
}

Result<EllipsoidBlock> decode_ellipsoids(const model::StoredBlock& stored,
                                         std::span<const model::EllipsoidSource> sources) {
  model::ByteReader reader(stored.bytes);
  EllipsoidBlock block;
  block.source = reader.get<uint32_t>();
  const auto flags = reader.get<uint8_t>();
  const auto zero = reader.get<int16_t>();
  block.grid = stored.grid;
  block.origin = stored.origin;
  block.extent = stored.extent;
  if (!reader.ok()) return damaged("cut off");
  if (block.source >= sources.size()) return damaged("ellipsoids of no source");
  if (flags > (kColorsBit | kMergedBit)) return damaged("unknown traits of ellipsoids");
  if (std::max({stored.extent.x, stored.extent.y, stored.extent.z}) >> kPositionBits != 0) {
    return damaged("a block of ellipsoids that is too large");
  }
  const model::EllipsoidSource& source = sources[block.source];
  const bool merged = (flags & kMergedBit) != 0;
  const Traits traits{(flags & kColorsBit) != 0, merged, scalar_types(source, merged)};
  const std::vector<size_t> columns = columns_of(traits);
  const Result<std::vector<model::Field>> fields =
      model::decode_fields(reader.rest(), columns, stored.items, columns.size());
  if (!fields) return fail(fields);
  if (Status status = read_fields(*fields, traits, zero, source, block); !status) return fail(status);
  return block;
}

}  // namespace surfcast::ellipsoid
