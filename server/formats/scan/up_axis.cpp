#include "scan/up_axis.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace surfcast::scan {
namespace {

bool is_lidar_attribute(const ScalarField& attribute) {
  constexpr std::array<std::string_view, 5> kNames = {"classification", "return_number", "number_of_returns",
                                                      "gps_time", "point_source_id"};
  return std::find(kNames.begin(), kNames.end(), attribute.name) != kNames.end();
}

}  // namespace

bool looks_like_survey(std::span<const ScalarField> scalars, const geometry::Box& bounds) {
  if (std::any_of(scalars.begin(), scalars.end(), is_lidar_attribute)) return true;
  if (bounds.empty()) return false;
  const glm::dvec3 size = bounds.size();
  // Projected coordinate systems have eastings and northings far from the origin, many times the size of the scene.
  const glm::dvec3 centre = glm::abs(bounds.centre());
  const double away = std::max(centre.x, centre.y);
  if (away > 1e4 && away > 10 * bounds.diagonal()) return true;
  return size.z > 0 && 2 * size.z <= std::min(size.x, size.y);
}

}  // namespace surfcast::scan
