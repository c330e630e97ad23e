#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace surfcast::model {

/// An order of points in which each is near the one before, so that the differences a coder stores are small: a greedy
/// path that goes to the nearest of the next few points of the given order, which should be a spatial one (Morton).
/// Returns positions in the given order.
std::vector<uint32_t> path_order(std::span<const glm::ivec3> points);

}  // namespace surfcast::model
