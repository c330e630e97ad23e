#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "picture/picture.h"

namespace surfcast::render {

inline constexpr size_t kMapEntries = 1024;

/// The colour of a map at t in [0, 1]; sRGB in [0, 1].
glm::dvec3 map_color(picture::ColorMap map, double t);
/// The colour of a LAS class, sRGB.
glm::u8vec3 class_color(uint8_t code);

/// kMapEntries colours of a map, in the format of a splat record (include/packing.glsl).
std::vector<uint32_t> map_color_table(picture::ColorMap map);
/// The colours of the 256 classes in the same format.
std::vector<uint32_t> class_color_table();

}  // namespace surfcast::render
