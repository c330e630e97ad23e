#pragma once

#include <glm/vec2.hpp>

#include "scan_random.h"
#include "scan_scene.h"

namespace surfcast::bench {

/// An echo of the forest over the place p, metres.
Echo forest_echo(const glm::dvec2& p, Dice& dice);

}  // namespace surfcast::bench
