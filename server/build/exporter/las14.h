#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "exporter/las_counts.h"

namespace surfcast::exporter {

/// The point format from 6 to 8 that has the fields of another one without wave packets.
int modern_point_format(int point_format);

/// Point records of formats 0 to 3 as those of formats 6 and 7, extra bytes included: the bits of returns, flags and
/// classes in their wider fields, scan angles in steps of 0.006 degrees, a GPS time of 0 where there is none. Records
/// of formats 6 to 8 stay as they are. `record_bytes`: of a record of `point_format`.
std::vector<std::byte> modern_records(std::vector<std::byte> records, int point_format, size_t record_bytes);

/// Turns a head into one of version 1.4 with point formats 6 to 8, which state their coordinate system as WKT. `crs`:
/// the system as the source states it. GeoKeys are left out, unless nothing knows their system. Returns what the file
/// does not say any more or in the wrong form, for people.
std::vector<std::string> become_version_14(LasHead& head, const std::string& crs);

}  // namespace surfcast::exporter
