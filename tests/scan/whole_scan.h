#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "scan/bytes.h"
#include "scan/scan_stream.h"

namespace surfcast::testing {

/// All points of a scan, and what is known of it as a whole.
struct WholeScan : scan::ScanPoints {
  std::string name = "scan";
  std::optional<surfel::Grid> grid;
  std::optional<glm::dvec3> sensor;
  bool z_up = true;
};

inline void append_points(scan::ScanPoints& to, const scan::ScanPoints& more) {
  to.positions.insert(to.positions.end(), more.positions.begin(), more.positions.end());
  to.normals.insert(to.normals.end(), more.normals.begin(), more.normals.end());
  to.radii.insert(to.radii.end(), more.radii.begin(), more.radii.end());
  if (more.colors && !to.colors) to.colors = surfel::ColorAttribute{more.colors->bits, {}};
  if (more.colors) {
    to.colors->values.insert(to.colors->values.end(), more.colors->values.begin(), more.colors->values.end());
  }
  if (to.scalars.empty()) {
    to.scalars = more.scalars;
    return;
  }
  for (size_t i = 0; i < to.scalars.size(); ++i) {
    std::visit(
        [&](auto& values) {
          const auto& added = std::get<std::decay_t<decltype(values)>>(more.scalars[i].values);
          values.insert(values.end(), added.begin(), added.end());
        },
        to.scalars[i].values);
  }
}

inline Result<WholeScan> whole(const Result<scan::ScanStream>& stream) {
  if (!stream) return fail(stream);
  WholeScan scan;
  for (size_t piece = 0; piece < stream->pieces(); ++piece) {
    const Result<scan::ScanPoints> points = stream->read(piece);
    if (!points) return fail(points);
    append_points(scan, *points);
  }
  const scan::ScanSchema& schema = stream->schema();
  scan.name = schema.name;
  scan.grid = schema.grid;
  scan.sensor = schema.sensor;
  scan.z_up = schema.z_up;
  return scan;
}

inline Result<WholeScan> read_whole(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  return whole(scan::ScanStream::open_content(bytes, path));
}

}  // namespace surfcast::testing
