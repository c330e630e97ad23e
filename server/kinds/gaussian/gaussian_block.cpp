#include "gaussian/gaussian_block.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "base/contract.h"
#include "model/byte_stream.h"
#include "model/field.h"
#include "model/item_lattice.h"
#include "model/path_order.h"
#include "surfel/even_sampling.h"

namespace surfcast::gaussian {
namespace {

constexpr double kDeviationOverError = 128;
constexpr uint8_t kAntialiasedBit = 8;
constexpr uint8_t kFlatBit = 16;
/// Fields of every block; those of the harmonics of degree 1 and more follow.
enum FieldNumber { kPositions, kScales, kLargestParts, kRotations, kOpacities, kColors, kFixedFields };

double middle_of(const glm::vec3& v) {
  const glm::dvec3 d(v);
  return std::max(std::min(d.x, d.y), std::min(std::max(d.x, d.y), d.z));
}

double tolerance_of(const Gaussians& gaussians) {
  std::vector<double> deviations;
  deviations.reserve(gaussians.size());
  for (const glm::vec3& scale : gaussians.scales) deviations.push_back(middle_of(scale));
  return model::item_tolerance(std::move(deviations), kDeviationOverError);
}

template <typename Value>
model::Column column_of(const std::vector<uint32_t>& path, const Value& value) {
  model::Column column;
  column.reserve(path.size());
  for (const uint32_t i : path) column.push_back(value(i));
  return column;
}

void add_harmonics(const std::vector<uint32_t>& path, const GaussianCodes& codes, std::vector<model::Field>& fields) {
  const size_t width = varying_coefficients(codes.traits.degree);
  for (int degree = 1; degree <= codes.traits.degree; ++degree) {
    model::Field field;
    for (size_t k = varying_coefficients(degree - 1); k < varying_coefficients(degree); ++k) {
      field.push_back(column_of(path, [&](uint32_t i) { return codes.harmonics[i * width + k]; }));
    }
    fields.push_back(std::move(field));
  }
}

std::vector<model::Field> fields_of(const std::vector<glm::ivec3>& indices, const GaussianCodes& codes,
                                    const std::vector<uint32_t>& path) {
  std::vector<model::Field> fields(kFixedFields);
  fields[kPositions] = model::vector_field(path, indices);
  fields[kScales] = model::vector_field(path, codes.scales);
  fields[kLargestParts] = {column_of(path, [&](uint32_t i) { return codes.rotations[i].largest; })};
  for (size_t part = 0; part < 3; ++part) {
    fields[kRotations].push_back(column_of(path, [&](uint32_t i) { return codes.rotations[i].parts.at(part); }));
  }
  fields[kOpacities] = {column_of(path, [&](uint32_t i) { return codes.opacities[i]; })};
  fields[kColors] = model::vector_field(path, codes.colors);
  add_harmonics(path, codes, fields);
  return fields;
}

std::vector<size_t> columns_of(int degree) {
  std::vector<size_t> columns{3, 3, 1, 3, 1, 3};
  for (int d = 1; d <= degree; ++d) columns.push_back(varying_coefficients(d) - varying_coefficients(d - 1));
  return columns;
}

/// False if a value is none that an encoder writes.
bool in_range(const std::vector<model::Field>& fields, const glm::u32vec3& extent) {
  using model::all_at_most;
  if (!model::within_extent(fields[kPositions], extent)) return false;
  for (size_t i = kFixedFields; i < fields.size(); ++i) {
    if (!all_at_most(fields[i], 2 * kHarmonicHalf)) return false;
  }
  return all_at_most(fields[kScales], 65535) && all_at_most(fields[kLargestParts], 3) &&
         all_at_most(fields[kRotations], 2 * kRotationHalf) && all_at_most(fields[kOpacities], 255) &&
         all_at_most(fields[kColors], kMaxColorCode);
}

template <typename Vector>
Vector vector_at(const model::Field& field, size_t i) {
  using T = typename Vector::value_type;
  return {static_cast<T>(field[0][i]), static_cast<T>(field[1][i]), static_cast<T>(field[2][i])};
}

void read_codes(const std::vector<model::Field>& fields, GaussianCodes& codes) {
  const size_t count = fields[kPositions][0].size();
  for (size_t i = 0; i < count; ++i) {
    codes.positions.push_back(vector_at<glm::uvec3>(fields[kPositions], i));
    codes.scales.push_back(vector_at<glm::u16vec3>(fields[kScales], i));
    const auto parts = vector_at<glm::u16vec3>(fields[kRotations], i);
    codes.rotations.push_back({static_cast<uint8_t>(fields[kLargestParts][0][i]), {parts.x, parts.y, parts.z}});
    codes.opacities.push_back(static_cast<uint8_t>(fields[kOpacities][0][i]));
    codes.colors.push_back(vector_at<glm::u16vec3>(fields[kColors], i));
    for (size_t f = kFixedFields; f < fields.size(); ++f) {
      for (const model::Column& column : fields[f]) codes.harmonics.push_back(static_cast<uint8_t>(column[i]));
    }
  }
}

tl::unexpected<Error> damaged(const char* what) {
  return fail(ErrorKind::kInvalidInput, what);
}

}  // namespace

model::EncodedBlock encode_gaussians(const Gaussians& gaussians, const BlockTraits& traits) {
  SURFCAST_EXPECTS(gaussians.size() > 0);
  model::EncodedBlock block;
  block.kind = kGaussianKind;
  block.items = static_cast<uint32_t>(gaussians.size());
  block.grid = model::item_lattice(gaussians.positions, tolerance_of(gaussians));
  const std::vector<glm::ivec3> indices = model::item_indices(gaussians.positions, block);
  const std::vector<uint32_t> path = model::path_order(indices);
  const GaussianCodes codes = encode_shapes(gaussians, traits);
  double largest = 0;
  for (const glm::u16vec3& s : codes.scales) largest = std::max(largest, decode_scale(std::max({s.x, s.y, s.z})));
  block.spacing = static_cast<float>(surfel::kRadiusOverSpacing * model::step_along(indices, path, block.grid.scale.x));
  block.max_radius = std::max(block.spacing, static_cast<float>(kDrawnDeviations / 2 * largest));
  model::ByteWriter writer;
  writer.put(
      static_cast<uint8_t>(traits.degree | (traits.antialiased ? kAntialiasedBit : 0) | (traits.flat ? kFlatBit : 0)));
  for (const uint8_t range : codes.ranges) writer.put(range);
  writer.put_bytes(model::encode_fields(fields_of(indices, codes, path)));
  block.bytes = std::move(writer).take();
  return block;
}

Result<GaussianBlock> decode_gaussians(const model::StoredBlock& stored) {
  model::ByteReader reader(stored.bytes);
  GaussianBlock block{{}, stored.grid, stored.origin, stored.extent};
  const auto traits = reader.get<uint8_t>();
  const int degree = traits & 7;
  block.codes.traits = {degree, (traits & kAntialiasedBit) != 0, (traits & kFlatBit) != 0};
  for (uint8_t& range : block.codes.ranges) range = reader.get<uint8_t>();
  if (!reader.ok()) return damaged("cut off");
  if (degree > kMaxDegree || traits >= 2 * kFlatBit) return damaged("unknown traits of Gaussians");
  if (std::max({stored.extent.x, stored.extent.y, stored.extent.z}) >> kPositionBits != 0) {
    return damaged("a block of Gaussians that is too large");
  }
  const std::vector<size_t> columns = columns_of(degree);
  const Result<std::vector<model::Field>> fields =
      model::decode_fields(reader.rest(), columns, stored.items, columns.size());
  if (!fields) return fail(fields);
  if (!in_range(*fields, stored.extent)) return damaged("values out of range");
  read_codes(*fields, block.codes);
  return block;
}

}  // namespace surfcast::gaussian
