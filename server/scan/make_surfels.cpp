#include "scan/make_surfels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "scan/clean_points.h"
#include "scan/estimate_normals.h"
#include "scan/merge_scans.h"
#include "scan/neighbours.h"
#include "scan/orient_normals.h"
#include "scan/spacing.h"

namespace surfcast {
namespace {

/// Neighbours of each site that its normal is estimated from.
constexpr size_t kDegree = 12;

bool usable_radius(float radius) {
  return std::isfinite(radius) && radius > 0;
}

void fill_radii(const Sites& sites, const NeighbourGraph& graph, SurfelCloud& cloud, SurfelReport& report) {
  cloud.radii.resize(cloud.size(), 0.0F);
  if (std::all_of(cloud.radii.begin(), cloud.radii.end(), usable_radius)) return;
  const std::vector<float> estimated = estimate_radii(sites, graph);
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (usable_radius(cloud.radii[i])) continue;
    cloud.radii[i] = estimated[sites.of_point[i]];
    ++report.radii_estimated;
  }
}

bool has_normal(const SurfelCloud& cloud, size_t i) {
  return !cloud.normals.empty() && !std::isnan(cloud.normals[i].x);
}

/// For every site what is known about its normal's sign: a stored normal there, or the way to the scanner.
std::vector<glm::vec3> known_directions(const Sites& sites, const SurfelCloud& cloud,
                                        const std::vector<std::optional<glm::dvec3>>& sensors) {
  std::vector<glm::vec3> towards(sites.size(), glm::vec3(0));
  for (size_t s = 0; s < cloud.sources.size(); ++s) {
    const SourceRange& source = cloud.sources[s];
    for (size_t i = source.first; i < source.first + source.count; ++i) {
      glm::vec3& direction = towards[sites.of_point[i]];
      if (has_normal(cloud, i)) {
        direction = cloud.normals[i];
      } else if (sensors[s] && *sensors[s] != cloud.positions[i]) {
        direction = glm::vec3(glm::normalize(*sensors[s] - cloud.positions[i]));
      }
    }
  }
  return towards;
}

/// The normal of the first point of each site.
std::vector<glm::vec3> site_normals(const Sites& sites, const SurfelCloud& cloud) {
  std::vector<glm::vec3> normals(sites.size());
  for (size_t i = cloud.size(); i-- > 0;) normals[sites.of_point[i]] = cloud.normals[i];
  return normals;
}

void fill_normals(const Sites& sites, const NeighbourGraph& graph,
                  const std::vector<std::optional<glm::dvec3>>& sensors, SurfelCloud& cloud, SurfelReport& report) {
  size_t stored = 0;
  for (size_t i = 0; i < cloud.size(); ++i) stored += has_normal(cloud, i) ? 1 : 0;
  if (stored == cloud.size()) {
    cloud.oriented = signs_agree(graph, site_normals(sites, cloud));
    return;
  }
  std::vector<glm::vec3> estimated = estimate_normals(sites, graph);
  cloud.oriented = orient_normals(sites, graph, known_directions(sites, cloud, sensors), cloud.z_up, estimated);
  const bool none_stored = stored == 0;
  cloud.normals.resize(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (none_stored || !has_normal(cloud, i)) cloud.normals[i] = estimated[sites.of_point[i]];
  }
  // Scans with normals of their own may disagree among themselves.
  if (!none_stored) cloud.oriented = cloud.oriented && signs_agree(graph, site_normals(sites, cloud));
  report.normals_estimated = cloud.size() - stored;
}

Status check_size(const SurfelCloud& cloud) {
  if (cloud.size() == 0) return fail(ErrorKind::kInvalidInput, "no usable point is left of the input");
  if (cloud.size() >= std::numeric_limits<uint32_t>::max()) {
    return fail(ErrorKind::kLimit, "more points than the 4294967294 that one model can have");
  }
  return {};
}

}  // namespace

Result<SurfelCloud> make_surfels(std::vector<ScanPoints> scans, SurfelReport& report) {
  report = {};
  std::vector<std::optional<glm::dvec3>> sensors;
  for (ScanPoints& scan : scans) {
    report.points_read += scan.size();
    drop_unusable_points(scan, report);
    sensors.push_back(scan.sensor);
  }
  SurfelCloud cloud = merge_scans(std::move(scans), report.notes);
  if (Status status = check_size(cloud); !status) return fail(status.error());
  drop_duplicates(cloud, report);
  const Sites sites = find_sites(cloud.positions);
  const NeighbourGraph graph = find_neighbours(sites, kDegree);
  fill_radii(sites, graph, cloud, report);
  fill_normals(sites, graph, sensors, cloud, report);
  report.oriented = cloud.oriented;
  return cloud;
}

}  // namespace surfcast
