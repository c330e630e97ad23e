#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "base/spool_file.h"
#include "isosurface/iso_surface.h"
#include "isosurface/surface_point.h"
#include "scan/row_source.h"

namespace surfcast::isosurface {

/// How points of surfaces are stored: packed records of place, normal, and what tells surfaces apart.
class PointRecords {
 public:
  PointRecords(const glm::dmat4x3& index_to_world, std::span<const IsoSurface> surfaces);

  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const { return columns_; }
  [[nodiscard]] size_t size() const { return size_; }  ///< of a record, bytes
  [[nodiscard]] double surface_step() const;           ///< see ScanSchema
  /// Appends the record of a point, in the world.
  void append(const SurfacePoint& point, const IsoSurface& surface, std::vector<std::byte>& records) const;

 private:
  glm::dmat4x3 index_to_world_;
  glm::dmat3 gradient_to_normal_;
  bool colored_;
  bool several_;
  std::vector<scan::ColumnInfo> columns_;
  size_t size_ = 0;
};

/// The records of a file as rows.
std::unique_ptr<scan::RowSource> rows_of(SpoolFile file, const PointRecords& records);

}  // namespace surfcast::isosurface
