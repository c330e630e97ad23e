#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "scan/scan_points.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::point_tree {

/// The values of some rows, appended to others.
template <typename T>
void append_rows(const std::vector<T>& from, std::span<const uint32_t> rows, std::vector<T>& to) {
  for (const uint32_t row : rows) to.push_back(from[row]);
}

inline void append_rows(const surfel::ScalarValues& from, std::span<const uint32_t> rows, surfel::ScalarValues& to) {
  std::visit([&](const auto& values) { append_rows(values, rows, std::get<std::decay_t<decltype(values)>>(to)); },
             from);
}

/// No points, with the attributes of others. `Points`: ScanPoints or SurfelCloud.
template <typename Points = scan::ScanPoints, typename From>
Points empty_like(const From& other) {
  Points none;
  if (other.colors) none.colors = surfel::ColorAttribute{other.colors->bits, {}};
  for (const surfel::ScalarAttribute& scalar : other.scalars) {
    none.scalars.push_back(
        {scalar.name,
         std::visit([](const auto& values) { return surfel::ScalarValues(std::decay_t<decltype(values)>()); },
                    scalar.values)});
  }
  return none;
}

/// Appends rows of points to points with the same attributes. Radii are not needed.
template <typename From, typename Points>
void append_points(const From& from, std::span<const uint32_t> rows, Points& to) {
  append_rows(from.positions, rows, to.positions);
  if (!from.normals.empty()) append_rows(from.normals, rows, to.normals);
  if (from.colors) append_rows(from.colors->values, rows, to.colors->values);
  for (size_t i = 0; i < from.scalars.size(); ++i) append_rows(from.scalars[i].values, rows, to.scalars[i].values);
}

/// Bytes of the attributes of one point.
inline size_t bytes_of_scalars(std::span<const surfel::ScalarAttribute> scalars) {
  size_t bytes = 0;
  for (const surfel::ScalarAttribute& scalar : scalars) {
    bytes += std::visit([](const auto& values) { return sizeof(values[0]); }, scalar.values);
  }
  return bytes;
}

}  // namespace surfcast::point_tree
