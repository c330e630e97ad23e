#pragma once

#include <glm/vec3.hpp>

#include "surfcast.pb.h"

namespace surfcast::net {

inline void to_wire(const glm::dvec3& v, wire::Vector3* message) {
  message->set_x(v.x);
  message->set_y(v.y);
  message->set_z(v.z);
}

}  // namespace surfcast::net
