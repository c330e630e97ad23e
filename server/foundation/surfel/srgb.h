#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace surfcast::surfel {

/// The transfer function of sRGB (IEC 61966-2-1) and its inverse, of values in [0, 1].
double decode_srgb(double encoded);
double encode_srgb(double linear);

/// Linear light in [0, 1] of an sRGB colour. `bits` is 8 or 16 per channel.
glm::vec3 to_linear(const glm::u16vec3& color, int bits);

/// The nearest sRGB colour of `bits` per channel. Light outside [0, 1] is clamped.
glm::u16vec3 from_linear(const glm::vec3& light, int bits);

}  // namespace surfcast::surfel
