#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "exporter/las_file_writer.h"
#include "geometry/box.h"
#include "scan/las_reader.h"
#include "scan/scan_points.h"
#include "scan/scan_schema.h"
#include "surfel/grid.h"

namespace surfcast::exporter {

/// Points as LAS is to hold them.
struct LasPoints {
  const scan::ScanSchema* schema = nullptr;  ///< outlives the plan
  geometry::Box bounds;                      ///< of all points
  uint64_t count = 0;
  std::optional<double> scale{};  ///< steps of the coordinates; none: see lattice_for
  bool compressed = false;
  bool modern = false;  ///< version 1.4 and point formats from 6 on, whatever suffices
};

/// Where the values of an attribute lie in a record.
struct LasPlace {
  size_t scalar = 0;  ///< number of the attribute in the schema
  scan::LasField field;
};

/// How points of any scan become point records.
struct LasTable {
  LasHead head;
  surfel::Grid grid;
  std::vector<LasPlace> places;
  size_t color_offset = 0;   ///< 0: no colours
  int color_factor = 1;      ///< to colours of 16 bits
  size_t normal_offset = 0;  ///< of three floats; 0: no normals
  size_t radius_offset = 0;  ///< of a float; 0: no radii
};

/// A lattice near the bounds, with these steps or else powers of ten: at most 0.001 and at least 2^-24 of the extent,
/// coarser where numbers of 32 bits or double precision ask for it.
surfel::Grid lattice_for(const geometry::Box& bounds, std::optional<double> scale);

/// Version 1.2 and point formats 0 to 3 where they suffice, else 1.4 and 6 to 8, which have room for all classes and
/// returns. Attributes without a field of the format, or of a type that does not fit into it, become extra bytes.
/// Colours of 8 bits become 16 (times 257). Fails where the scale is too fine or there are too many attributes.
Result<LasTable> plan_las_table(const LasPoints& points);

/// The records of those points whose coordinates are finite. Fails if a value does not fit into its bits.
Result<std::vector<std::byte>> las_records_of(const scan::ScanPoints& points, const LasTable& table);

}  // namespace surfcast::exporter
