#include "scan/read_scan.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/mapped_file.h"
#include "geometry/box.h"
#include "scan/draco_reader.h"
#include "scan/las_reader.h"
#include "scan/pcd_reader.h"
#include "scan/ply_reader.h"
#include "scan/ptx_reader.h"
#include "scan/scan_format.h"
#include "scan/text_reader.h"

namespace surfcast {
namespace {

Result<ScanPoints> read_format(ScanFormat format, std::span<const std::byte> bytes) {
  switch (format) {
    case ScanFormat::kPly:
      return read_ply(bytes);
    case ScanFormat::kLas:
      return read_las(bytes);
    case ScanFormat::kPcd:
      return read_pcd(bytes);
    case ScanFormat::kPtx:
      return read_ptx(bytes);
    case ScanFormat::kDraco:
      return read_draco(bytes);
    case ScanFormat::kText:
      break;
  }
  return read_text(bytes);
}

/// A scanner at the origin, farther from all points than they spread, is a default of the writer's and no scanner.
void drop_default_sensor(ScanPoints& points) {
  if (points.sensor != glm::dvec3(0)) return;
  const Box box = finite_bounds(points.positions);
  const glm::dvec3 nearest = glm::clamp(glm::dvec3(0), box.min, box.max);
  if (box.empty() || glm::length(nearest) > box.diagonal()) points.sensor.reset();
}

}  // namespace

Result<ScanPoints> read_scan_content(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  Result<ScanPoints> points =
      scan_format_of(bytes, path).and_then([bytes](ScanFormat format) { return read_format(format, bytes); });
  if (!points) return fail(points.error().kind, path.string() + ": " + points.error().message);
  points->name = path.filename().string();
  drop_default_sensor(*points);
  return points;
}

Result<ScanPoints> read_scan(const std::filesystem::path& path) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file.error());
  return read_scan_content(file->bytes(), path);
}

}  // namespace surfcast
