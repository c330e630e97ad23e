#pragma once

#include <array>
#include <filesystem>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::colorize {

/// A picture and the camera that took it: a pinhole with the distortion of Brown and Conrady.
struct PhotoCamera {
  std::filesystem::path image;
  glm::dvec3 position{0};
  glm::dmat3 to_camera{1};  ///< world directions to x right, y down, z forward
  glm::dvec2 focal{1};      ///< pixels
  glm::dvec2 principal{0};  ///< pixels from the upper left corner
  std::array<double, 3> radial{};
  std::array<double, 2> tangential{};

  struct Seen {
    glm::dvec2 pixel{0};
    glm::dvec3 local{0};  ///< in the camera's frame
  };
  /// None behind the camera.
  [[nodiscard]] std::optional<Seen> project(const glm::dvec3& world) const;
};

/// Reads {"cameras": [{"image": NAME, "position": [x, y, z], "rotation": [nine numbers, row by row], "focal": [fx, fy],
/// "principal_point": [cx, cy], "radial": [k1, k2, k3], "tangential": [p1, p2]}, ...]}. Images are in the folder of the
/// file `path` or below; distortion may be left out. Fails where numbers are missing or a rotation is none.
Result<std::vector<PhotoCamera>> parse_cameras(std::string_view text, const std::filesystem::path& path);

}  // namespace surfcast::colorize
