#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/camera.h"

namespace surfcast::lab {

/// How a scan is looked at.
enum class Place {
  kGround,  ///< a landscape or a town: from above, slanted, near, and five views close to the ground
  kSweep,   ///< the same, and one view from beside the scanner, which stands at the origin
  kObject,  ///< from all around
  kRoom,    ///< from above, slanted, near, and five views from the emptiest place inside
  kSensor,  ///< one depth picture of a sensor at the origin: from beside it, and around what it saw
};

/// A scan, and how it is looked at.
struct PlacedScan {
  std::optional<Place> place;
  std::filesystem::path path;
};

/// Reads PLACE:PATH; without the name of a place before the first colon, all is the path.
PlacedScan placed_scan(const std::string& argument);

/// None for an unknown name. The names are ground, sweep, object, room and sensor.
std::optional<Place> place_named(std::string_view name);

struct NamedCamera {
  std::string name;
  geometry::Camera camera;
};

/// Cameras that depend only on the points. `spacings` has the mean distance of each point to its nearest ones. The
/// vertical axis is z or y.
std::vector<NamedCamera> leave_out_cameras(std::span<const glm::dvec3> points, std::span<const double> spacings,
                                           Place place, bool z_up);

}  // namespace surfcast::lab
