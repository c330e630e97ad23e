#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::scan {

/// What a buffer view of EXT_meshopt_compression states.
struct MeshoptView {
  uint64_t count = 0;       ///< elements
  uint64_t stride = 0;      ///< bytes of an element
  std::string_view mode;    ///< ATTRIBUTES, INDICES, TRIANGLES
  std::string_view filter;  ///< empty, NONE, OCTAHEDRAL, EXPONENTIAL, QUATERNION
};

/// True if so few bytes may stand for that many elements.
bool meshopt_claim_is_plausible(std::span<const std::byte> packed, const MeshoptView& view);

/// The elements, in a plain run of bytes. Lists of triangles and rotations, which points do not have, are not
/// supported.
Result<std::vector<std::byte>> decode_meshopt(std::span<const std::byte> packed, const MeshoptView& view);

}  // namespace surfcast::scan
