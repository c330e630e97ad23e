#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace surfcast::model {

/// Orders points so that consecutive ones are close together, which keeps the differences that a coder stores small.
/// The order is a greedy path: from each point to the nearest of the next few points of the given order, which should
/// be a spatial one (Morton). Returns indices into `points`.
std::vector<uint32_t> path_order(std::span<const glm::ivec3> points);

}  // namespace surfcast::model
