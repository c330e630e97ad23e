#include "builder/cloud_columns.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace surfcast::builder {

surfel::SurfelCloud empty_cloud(const scan::ScanSchema& schema, size_t size) {
  surfel::SurfelCloud cloud;
  cloud.z_up = schema.z_up;
  cloud.estimated_normals = !schema.normals;
  cloud.estimated_radii = !schema.radii;
  cloud.positions.resize(size);
  if (schema.normals) cloud.normals.resize(size);
  if (schema.radii) cloud.radii.resize(size);
  if (schema.color_bits != 0) cloud.colors = surfel::ColorAttribute{schema.color_bits, std::vector<glm::u16vec3>(size)};
  for (const scan::ScalarField& field : schema.scalars) {
    surfel::ScalarValues values = scan::empty_values(field.type);
    std::visit([size](auto& typed) { typed.resize(size); }, values);
    cloud.scalars.push_back({field.name, std::move(values)});
  }
  return cloud;
}

std::vector<std::span<std::byte>> column_memory(surfel::SurfelCloud& cloud, size_t first, size_t count) {
  std::vector<std::span<std::byte>> memory;
  for_each_column(
      cloud, [&](auto& values) { memory.push_back(std::as_writable_bytes(std::span(values).subspan(first, count))); });
  return memory;
}

void copy_points(const scan::ScanPoints& points, size_t first, surfel::SurfelCloud& cloud) {
  const std::vector<std::span<std::byte>> memory = column_memory(cloud, first, points.size());
  size_t column = 0;
  for_each_column(points, [&](const auto& values) {
    std::memcpy(memory[column++].data(), values.data(), values.size() * sizeof(values[0]));
  });
}

void append_columns(const scan::ScanPoints& points, std::span<const uint32_t> rows, std::vector<std::byte>& bytes) {
  for_each_column(points, [&](const auto& values) {
    using Value = typename std::decay_t<decltype(values)>::value_type;
    const size_t first = bytes.size();
    bytes.resize(first + rows.size() * sizeof(Value));
    std::byte* at = bytes.data() + first;
    for (const uint32_t row : rows) {
      std::memcpy(at, &values[row], sizeof(Value));
      at += sizeof(Value);
    }
  });
}

}  // namespace surfcast::builder
