#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/scalar_type.h"

namespace surfcast::scan {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat32;  ///< of the value, or of the entries of a list
  std::optional<ScalarType> list_count;    ///< for a list: the type of its length
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { kAscii, kBinaryLittleEndian, kBinaryBigEndian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  size_t data_offset = 0;  ///< of the first byte after the line "end_header"
};

Result<PlyHeader> parse_ply_header(std::span<const std::byte> bytes);

}  // namespace surfcast::scan
