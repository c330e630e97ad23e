#pragma once

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <string>
#include <vector>

#include "geometry/camera.h"

namespace surfcast::bench {

using geometry::Camera;

/// The camera some seconds after `begin`.
using Movement = std::function<Camera(const Camera& begin, double seconds)>;

struct Path {
  std::string name;
  Movement at;
};

inline glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double degrees) {
  const double angle = glm::radians(degrees);
  return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) + axis * glm::dot(axis, v) * (1 - std::cos(angle));
}

inline Camera orbit(const Camera& begin, double degrees) {
  Camera camera = begin;
  camera.position =
      begin.focal_point + rotated(begin.position - begin.focal_point, glm::normalize(begin.view_up), degrees);
  return camera;
}

inline Camera moved(const Camera& begin, const glm::dvec3& by) {
  Camera camera = begin;
  camera.position += by;
  camera.focal_point += by;
  return camera;
}

inline std::vector<Path> paths() {
  const auto dolly = [](const Camera& begin, double seconds) {
    Camera camera = begin;
    camera.position = begin.focal_point + (begin.position - begin.focal_point) * std::pow(2, -seconds);
    return camera;
  };
  const auto fly = [](const Camera& begin, double seconds) {
    return moved(begin, (begin.focal_point - begin.position) * (0.5 * seconds));
  };
  const auto fly_and_turn = [fly](const Camera& begin, double seconds) {
    Camera camera = fly(begin, seconds);
    camera.focal_point =
        camera.position + rotated(camera.focal_point - camera.position, glm::normalize(begin.view_up), 30 * seconds);
    return camera;
  };
  const auto pan = [](const Camera& begin, double seconds) {
    const glm::dvec3 view = begin.focal_point - begin.position;
    const double height = 2 * glm::length(view) * std::tan(glm::radians(begin.view_angle / 2));
    return moved(begin, glm::normalize(glm::cross(view, begin.view_up)) * (height * seconds));
  };
  return {{"orbit, 45 degrees a second", [](const Camera& c, double s) { return orbit(c, 45 * s); }},
          {"dolly, 2 times a second", dolly},
          {"flight", fly},
          {"flight and turn", fly_and_turn},
          {"pan, a height a second", pan}};
}

}  // namespace surfcast::bench
