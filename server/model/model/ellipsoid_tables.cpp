#include <algorithm>
#include <cmath>
#include <utility>

#include "model/kind_tables.h"

namespace surfcast::model {
namespace {

/// Bytes of an attribute and of a source with empty strings and no attributes.
constexpr size_t kAttributeBytes = 4 + 1 + 2 * 8;
constexpr size_t kSourceBytes = 4 + 1 + 3 * 4 + 12 * 8 + 1 + 2 * 4 + 3 * 8 + 6 * 8 + 5 * 8 + 4;

tl::unexpected<Error> damaged_table(const char* what) {
  return fail(ErrorKind::kInvalidInput, what);
}

/// Calls `visit` for each number of a source but for the names and the attributes, in the order of the file.
void for_each_number(auto& source, const auto& visit) {
  for (int axis = 0; axis < 3; ++axis) visit(source.size[axis]);
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) visit(source.index_to_world[column][row]);
  }
  for (auto* value : {&source.high, &source.reach, &source.largest}) visit(*value);
  auto& counts = source.counts;
  for (auto* count : {&counts.samples, &counts.masked, &counts.not_finite, &counts.not_positive, &counts.drawn,
                      &counts.anisotropic}) {
    visit(*count);
  }
  for (auto* value : {&source.mean_anisotropy, &source.mean_mode}) visit(*value);
  for (int axis = 0; axis < 3; ++axis) visit(source.mean_values[axis]);
}

void put_source(ByteWriter& writer, const EllipsoidSource& source) {
  writer.put_string(source.name);
  writer.put(static_cast<uint8_t>(source.tensors ? 1 : 0));
  writer.put(static_cast<uint8_t>(source.frame));
  writer.put_string(source.length_unit);
  writer.put_string(source.sample_unit);
  for_each_number(source, [&writer](auto value) { writer.put(value); });
  writer.put(static_cast<uint32_t>(source.attributes.size()));
  for (const EllipsoidAttribute& attribute : source.attributes) {
    writer.put_string(attribute.name);
    writer.put(attribute.type);
    writer.put(attribute.smallest);
    writer.put(attribute.largest);
  }
}

EllipsoidSource get_source(ByteReader& reader) {
  EllipsoidSource source;
  source.name = reader.get_string();
  source.tensors = reader.get<uint8_t>() != 0;
  source.frame = static_cast<WorldFrame>(reader.get<uint8_t>());
  source.length_unit = reader.get_string();
  source.sample_unit = reader.get_string();
  for_each_number(source, [&reader](auto& value) { value = reader.get<std::decay_t<decltype(value)>>(); });
  const auto attributes = reader.get<uint32_t>();
  if (attributes > reader.rest().size() / kAttributeBytes) return source;  // no valid source: it has no attributes
  for (uint32_t i = 0; i < attributes; ++i) {
    EllipsoidAttribute attribute;
    attribute.name = reader.get_string();
    attribute.type = reader.get<uint8_t>();
    attribute.smallest = reader.get<double>();
    attribute.largest = reader.get<double>();
    source.attributes.push_back(std::move(attribute));
  }
  return source;
}

bool valid_attribute(const EllipsoidAttribute& attribute) {
  return !attribute.name.empty() && attribute.type < std::variant_size_v<surfel::ScalarValues> &&
         std::isfinite(attribute.smallest) && std::isfinite(attribute.largest) &&
         attribute.smallest <= attribute.largest;
}

bool valid_grid(const EllipsoidSource& source) {
  const glm::u32vec3& size = source.size;
  if (source.on_grid()) return std::min(size.y, size.z) >= 1 && source.least_step() > 0;
  return size.y == 0 && size.z == 0;
}

bool valid_source(const EllipsoidSource& source) {
  bool finite = true;
  for_each_number(source, [&finite](auto value) { finite = finite && std::isfinite(static_cast<double>(value)); });
  const bool values = source.high > 0 && source.reach > 0 && source.largest > 0 && std::isfinite(source.scale());
  return finite && values && valid_grid(source) && static_cast<uint8_t>(source.frame) < kWorldFrames &&
         source.attributes.size() >= kDerivedAttributes &&
         source.attributes.size() <= kDerivedAttributes + kMaxScalars &&
         std::all_of(source.attributes.begin(), source.attributes.end(), valid_attribute);
}

}  // namespace

void put_ellipsoid_sources(ByteWriter& writer, const Directory& directory) {
  writer.put(static_cast<uint32_t>(directory.ellipsoids.size()));
  for (const EllipsoidSource& source : directory.ellipsoids) put_source(writer, source);
}

Status get_ellipsoid_sources(ByteReader& reader, Directory& directory) {
  const auto sources = reader.get<uint32_t>();
  if (sources > reader.rest().size() / kSourceBytes) return damaged_table("model tables have a wrong length");
  for (uint32_t i = 0; i < sources; ++i) {
    directory.ellipsoids.push_back(get_source(reader));
    if (!reader.ok() || !valid_source(directory.ellipsoids.back())) {
      return damaged_table("model has a wrong source of ellipsoids");
    }
  }
  return {};
}

}  // namespace surfcast::model
