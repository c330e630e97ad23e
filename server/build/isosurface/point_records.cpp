#include "isosurface/point_records.h"

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <utility>

#include "builder/spooled_rows.h"

namespace surfcast::isosurface {
namespace {

using scan::ScalarType;

/// sRGB, the grey in which models without colours are drawn (kGrey of shaders/include/resolve.glsl).
constexpr uint8_t kGrey = 231;

template <typename T>
void put(const T& value, std::vector<std::byte>& bytes) {
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof(T));
}

}  // namespace

PointRecords::PointRecords(const glm::dmat4x3& index_to_world, std::span<const IsoSurface> surfaces)
    : index_to_world_(index_to_world),
      gradient_to_normal_(glm::transpose(glm::inverse(glm::dmat3(index_to_world)))),
      colored_(std::any_of(surfaces.begin(), surfaces.end(), [](const IsoSurface& s) { return s.color.has_value(); })),
      several_(surfaces.size() > 1) {
  for (const char* name : {"x", "y", "z"}) columns_.push_back({name, ScalarType::kFloat64});
  for (const char* name : {"nx", "ny", "nz"}) columns_.push_back({name, ScalarType::kFloat32});
  if (several_) columns_.push_back({"iso_value", ScalarType::kFloat32});
  if (colored_) {
    for (const char* name : {"red", "green", "blue"}) columns_.push_back({name, ScalarType::kUint8});
  }
  for (const scan::ColumnInfo& column : columns_) size_ += scan::size_of(column.type);
}

/// The longest step of the grid.
double PointRecords::surface_step() const {
  return std::max({glm::length(index_to_world_[0]), glm::length(index_to_world_[1]), glm::length(index_to_world_[2])});
}

void PointRecords::append(const SurfacePoint& point, const IsoSurface& surface, std::vector<std::byte>& records) const {
  put(index_to_world_ * glm::dvec4(point.place, 1), records);
  put(glm::vec3(-glm::normalize(gradient_to_normal_ * glm::normalize(point.gradient))), records);
  if (several_) put(static_cast<float>(surface.value), records);
  if (colored_) put(surface.color.value_or(glm::u8vec3(kGrey)), records);
}

std::unique_ptr<scan::RowSource> rows_of(SpoolFile file, const PointRecords& records) {
  scan::RowTraits traits;
  traits.surface_step = records.surface_step();
  return builder::spooled_rows(std::move(file), records.columns(), traits);
}

}  // namespace surfcast::isosurface
