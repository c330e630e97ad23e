#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "base/byte_source.h"
#include "base/result.h"
#include "geometry/box.h"
#include "geometry/zone.h"

namespace surfcast::scan {

/// What the info record of a COPC file states (COPC 1.0).
struct CopcInfo {
  glm::dvec3 low{0};   ///< lowest corner of the cube of the root
  double side = 0;     ///< of that cube
  double spacing = 0;  ///< of the points of the root; as stated
  ByteRange root;      ///< page of the hierarchy
};

/// `record`: the body of the info record.
Result<CopcInfo> read_copc_info(std::span<const std::byte> record);

/// A node of the octree. Its points are a chunk of the file.
struct CopcNode {
  int32_t level = 0;
  glm::ivec3 place{0};  ///< in cells of that level
  ByteRange chunk;
  uint64_t points = 0;
};

/// What is read of a COPC file.
struct CopcNodes {
  std::vector<CopcNode> nodes;  ///< in the order of the pages; those without points, too
  uint64_t page_bytes = 0;      ///< of the pages of the hierarchy that were read
};

/// The nodes of a COPC file that may have points in the zone. Reads no page of the hierarchy whose nodes all lie
/// elsewhere, and no page twice: a page within itself is an error. Pages of one depth are announced together. kLimit if
/// the pages have more than `most_bytes`. Whether the chunks lie within the file is not checked.
Result<CopcNodes> read_copc_nodes(const ByteSource& file, const CopcInfo& info, const geometry::Zone& zone,
                                  uint64_t most_bytes = std::numeric_limits<uint64_t>::max());

}  // namespace surfcast::scan
