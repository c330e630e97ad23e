#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.h"
#include "scan/las_header.h"
#include "surfel/grid.h"

namespace surfcast::exporter {

/// What a LAS file says before its points (LAS 1.4, tables 3 and 6).
struct LasHead {
  std::vector<std::byte> header;                 ///< figures that follow from the points are filled in later
  std::vector<std::vector<std::byte>> records;   ///< variable length records, head and body
  std::vector<std::vector<std::byte>> extended;  ///< extended ones, behind the points
  int point_format = 0;                          ///< 0 to 3 and 6 to 8
  size_t record_length = 0;                      ///< bytes
  bool compressed = false;                       ///< LAZ
  uint32_t chunk_size = 50000;                   ///< points of a chunk of LAZ

  /// From version 1.4 on.
  [[nodiscard]] bool has_wide_counts() const;
};

/// What follows from the points.
struct LasCounts {
  uint64_t points = 0;
  std::array<uint64_t, 15> returns{};  ///< by return number, from 1
  std::array<int32_t, 3> low{INT32_MAX, INT32_MAX, INT32_MAX};
  std::array<int32_t, 3> high{INT32_MIN, INT32_MIN, INT32_MIN};

  /// Counts records of `head.record_length` bytes.
  void add(std::span<const std::byte> records, const LasHead& head);
};

/// Adds the record before the points that tells how they are coded, if it is LAZ.
void add_laszip_record(LasHead& head);

/// The header's figures.
void fill_in_header(LasHead& head, const LasCounts& counts, size_t data_offset);

/// Leaves out the records behind the points.
void drop_extended_records(LasHead& head);

/// What readers of a file with this head know of its points, but for their number and bounds.
scan::LasHeader header_of(LasHead head);

/// The bounds of the points, world units.
geometry::Box bounds_of(const surfel::Grid& grid, const LasCounts& counts);

/// The header and the records before the points, and for LAZ the place of the chunk table, not known: -1.
std::vector<std::byte> bytes_before_points(const LasHead& head);

}  // namespace surfcast::exporter
