#include "scan/surfels_of.h"

#include "scan/clean_points.h"
#include "scan/make_surfels.h"
#include "scan/merge_schemas.h"
#include "scan/unit_normal.h"

namespace surfcast::testing {
namespace {

ScanSchema schema_of(const WholeScan& scan) {
  ScanSchema schema;
  schema.name = scan.name;
  schema.grid = scan.grid;
  schema.normals = std::any_of(scan.normals.begin(), scan.normals.end(),
                               [](const glm::vec3& n) { return unit_or_zero(n) != glm::vec3(0); });
  schema.radii = !scan.radii.empty();
  schema.color_bits = scan.colors ? scan.colors->bits : 0;
  for (const ScalarAttribute& scalar : scan.scalars) schema.scalars.push_back({scalar.name, type_of(scalar.values)});
  schema.sensor = scan.sensor;
  schema.z_up = scan.z_up;
  return schema;
}

SurfelCloud cloud_of(ScanPoints points, std::vector<SourceRange> sources) {
  SurfelCloud cloud;
  cloud.positions = std::move(points.positions);
  cloud.normals = std::move(points.normals);
  cloud.radii = std::move(points.radii);
  cloud.colors = std::move(points.colors);
  cloud.scalars = std::move(points.scalars);
  cloud.sources = std::move(sources);
  return cloud;
}

}  // namespace

SurfelCloud surfels_of(std::vector<WholeScan> scans, SurfelReport& report) {
  std::vector<ScanSchema> schemas;
  for (WholeScan& scan : scans) {
    schemas.push_back(schema_of(scan));
    if (!schemas.back().normals) scan.normals.clear();
  }
  const ScanSchema merged = merge_schemas(schemas);
  report.notes = describe_fillings(schemas, merged);
  ScanPoints all;
  PartFrame frame;
  std::vector<SourceRange> sources;
  for (WholeScan& scan : scans) {
    report.points_read += scan.size();
    drop_unusable_points(scan, report);
    sources.push_back({scan.name, all.size(), scan.size(), scan.grid});
    frame.sensors.push_back(scan.sensor);
    for (const glm::dvec3& p : scan.positions) frame.bounds.include(p);
    append_points(all, conform(scan, merged));
  }
  SurfelCloud cloud = cloud_of(std::move(all), std::move(sources));
  cloud.z_up = merged.z_up;
  std::vector<bool> keep = find_duplicates(cloud);
  report.duplicates = static_cast<uint64_t>(std::count(keep.begin(), keep.end(), true));
  keep.flip();
  keep_surfels(cloud, keep);
  std::vector<PartSigns> signs(1);
  PartSurfels surfels = make_surfels(std::move(cloud), frame, signs[0], report);
  settle_normals(settle_signs(signs, {frame.bounds, merged.z_up, merged.normals}), 0, surfels);
  return surfels.cloud;
}

}  // namespace surfcast::testing
