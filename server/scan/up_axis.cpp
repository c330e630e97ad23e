#include "scan/up_axis.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "geometry/box.h"

namespace surfcast {
namespace {

bool is_lidar_attribute(const ScalarAttribute& attribute) {
  constexpr std::array<std::string_view, 5> kNames = {"classification", "return_number", "number_of_returns",
                                                      "gps_time", "point_source_id"};
  return std::find(kNames.begin(), kNames.end(), attribute.name) != kNames.end();
}

}  // namespace

bool looks_like_survey(const ScanPoints& points) {
  if (std::any_of(points.scalars.begin(), points.scalars.end(), is_lidar_attribute)) return true;
  const Box box = finite_bounds(points.positions);
  if (box.empty()) return false;
  const glm::dvec3 size = box.size();
  // Projected coordinate systems put eastings and northings far from the origin, many times the size of the scene.
  const glm::dvec3 centre = glm::abs(box.centre());
  const double away = std::max(centre.x, centre.y);
  if (away > 1e4 && away > 10 * box.diagonal()) return true;
  return size.z > 0 && 2 * size.z <= std::min(size.x, size.y);
}

}  // namespace surfcast
