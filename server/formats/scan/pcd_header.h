#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/scalar_type.h"

namespace surfcast::scan {

struct PcdField {
  std::string name;  ///< "_" is padding
  ScalarType type = ScalarType::kFloat32;
  size_t count = 1;  ///< number of values per point

  [[nodiscard]] size_t bytes() const { return size_of(type) * count; }
};

enum class PcdEncoding { kAscii, kBinary, kBinaryCompressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  uint64_t points = 0;
  bool organised = false;            ///< a depth image: more than one row
  std::optional<glm::dvec3> sensor;  ///< see parse_pcd_header
  PcdEncoding encoding = PcdEncoding::kAscii;
  size_t data_offset = 0;

  [[nodiscard]] size_t record_length() const;
};

/// Parses and checks the header of a PCD file. The sensor position comes from VIEWPOINT. A viewpoint at the origin
/// counts only if it is rotated or the cloud is organised, because many writers store the default viewpoint in any
/// cloud.
Result<PcdHeader> parse_pcd_header(std::span<const std::byte> bytes);

}  // namespace surfcast::scan
