#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <vector>

namespace surfcast::kinds {

/// What a picture shows of one volume.
struct VolumeSight {
  struct Iso {
    double value = 0;
    double opacity = 1;
  };
  struct Plane {
    glm::dvec3 point{0};  ///< world
    glm::dvec3 normal{0, 0, 1};
    double opacity = 1;
  };

  std::function<double(double value)> extinction;             ///< of the transfer function, 1 / world unit
  std::function<bool(double low, double high)> shows_within;  ///< something of the values from `low` to `high`
  std::vector<Iso> isos;
  std::vector<Plane> planes;
};

}  // namespace surfcast::kinds
