#pragma once

#include <cstdint>
#include <glm/ext/vector_uint3_sized.hpp>
#include <optional>

namespace surfcast::isosurface {

/// A surface that is wanted of grids: where their samples, in their own unit, have one value.
struct IsoSurface {
  double value = 0;                    ///< finite
  std::optional<glm::u8vec3> color{};  ///< sRGB
};

}  // namespace surfcast::isosurface
