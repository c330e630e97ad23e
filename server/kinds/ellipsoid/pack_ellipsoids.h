#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <vector>

#include "ellipsoid/ellipsoid_block.h"

namespace surfcast::ellipsoid {

/// The most columns that the GPU knows; further ones have no effect on pictures.
inline constexpr size_t kMaxPackedColumns = 244;

/// Texels of an ellipsoid with so many columns.
[[nodiscard]] constexpr uint32_t texels_per_ellipsoid(size_t columns) {
  return 2 + static_cast<uint32_t>(((columns < kMaxPackedColumns ? columns : kMaxPackedColumns) + 3) / 4);
}

/// Texels of so many ellipsoids. None crosses the end of a page.
[[nodiscard]] constexpr uint64_t packed_texels(uint64_t count, size_t columns, uint32_t page) {
  const uint32_t each = texels_per_ellipsoid(columns);
  const uint64_t in_page = page / each;
  return count / in_page * page + count % in_page * each;
}

/// Ellipsoids as the GPU reads them (shaders/shared/ellipsoid_layout.h).
std::vector<glm::uvec4> pack_ellipsoids(const EllipsoidBlock& block, uint32_t page);

}  // namespace surfcast::ellipsoid
