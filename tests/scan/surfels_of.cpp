#include "scan/surfels_of.h"

#include "estimation/clean_points.h"
#include "estimation/make_surfels.h"
#include "scan/merge_schemas.h"
#include "scan/unit_normal.h"

namespace surfcast::testing {
namespace {

scan::ScanSchema schema_of(const WholeScan& scan) {
  scan::ScanSchema schema;
  schema.name = scan.name;
  schema.grid = scan.grid;
  schema.normals = std::any_of(scan.normals.begin(), scan.normals.end(),
                               [](const glm::vec3& n) { return scan::unit_or_zero(n) != glm::vec3(0); });
  schema.radii = !scan.radii.empty();
  schema.color_bits = scan.colors ? scan.colors->bits : 0;
  for (const surfel::ScalarAttribute& scalar : scan.scalars)
    schema.scalars.push_back({scalar.name, scan::type_of(scalar.values)});
  schema.sensor = scan.sensor;
  schema.z_up = scan.z_up;
  return schema;
}

surfel::SurfelCloud cloud_of(scan::ScanPoints points, std::vector<surfel::SourceRange> sources) {
  surfel::SurfelCloud cloud;
  cloud.positions = std::move(points.positions);
  cloud.normals = std::move(points.normals);
  cloud.radii = std::move(points.radii);
  cloud.colors = std::move(points.colors);
  cloud.scalars = std::move(points.scalars);
  cloud.sources = std::move(sources);
  return cloud;
}

}  // namespace

surfel::SurfelCloud surfels_of(std::vector<WholeScan> scans, estimation::SurfelReport& report,
                               estimation::RadiusPolicy radii) {
  std::vector<scan::ScanSchema> schemas;
  for (WholeScan& scan : scans) {
    schemas.push_back(schema_of(scan));
    if (!schemas.back().normals) scan.normals.clear();
  }
  const scan::ScanSchema merged = scan::merge_schemas(schemas);
  report.notes = scan::describe_fillings(schemas, merged);
  scan::ScanPoints all;
  estimation::PartFrame frame;
  frame.radii = radii;
  std::vector<surfel::SourceRange> sources;
  for (WholeScan& scan : scans) {
    report.points_read += scan.size();
    estimation::drop_unusable_points(scan, report);
    sources.push_back({scan.name, all.size(), scan.size(), scan.grid});
    frame.inputs.push_back(frame.inputs.size());
    frame.sensors.push_back(scan.sensor);
    for (const glm::dvec3& p : scan.positions) frame.bounds.include(p);
    append_points(all, scan::conform(scan, merged));
  }
  surfel::SurfelCloud cloud = cloud_of(std::move(all), std::move(sources));
  cloud.z_up = merged.z_up;
  std::vector<bool> keep = estimation::find_duplicates(cloud);
  report.duplicates = static_cast<uint64_t>(std::count(keep.begin(), keep.end(), true));
  keep.flip();
  estimation::keep_surfels(cloud, keep);
  std::vector<estimation::PartSigns> signs(1);
  estimation::PartSurfels surfels = estimation::make_surfels(std::move(cloud), frame, signs[0], report);
  estimation::apply_signs(estimation::resolve_signs(signs, {frame.bounds, merged.z_up, merged.normals}), 0, surfels);
  std::vector<estimation::RadiusDecision> decisions;
  for (const estimation::RadiusComparison& comparison : surfels.radii) {
    decisions.push_back(estimation::decide_radii(comparison, radii));
    report.radii_estimated += decisions.back().estimated();
    report.scatter += decisions.back().scatter();
  }
  estimation::apply_radii(decisions, frame.inputs, surfels.estimates,
                          estimation::SurfaceSpacing(surfels.samples, frame.bounds), surfels.cloud);
  return surfels.cloud;
}

}  // namespace surfcast::testing
