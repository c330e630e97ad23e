#pragma once

#include <glm/vec3.hpp>

#include "model/volume.h"

namespace surfcast::model {

/// A type of numbers, as in ScalarColumn::type: "uint8", "float32" and so on.
[[nodiscard]] const char* type_name(uint8_t type);
[[nodiscard]] inline const char* type_name(const Volume& volume) {
  return type_name(volume.type);
}
/// "RAS", "LAS" or "LPS"; empty if unstated.
[[nodiscard]] const char* frame_name(const Volume& volume);
/// Distances of neighbouring samples along i, j and k, in world units.
[[nodiscard]] glm::dvec3 spacing_of(const Volume& volume);

}  // namespace surfcast::model
