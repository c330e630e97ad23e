#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scan/bytes.h"

namespace surfcast::testing {

/// Writes LAS files byte by byte, after the specification and not after the reader.
struct LasFile {
  int minor = 2;
  int format = 0;
  int extra_bytes = 0;  ///< behind the fields of each record
  double scale[3] = {0.01, 0.01, 0.01};
  double offset[3] = {0, 0, 0};
  std::string variable_records;
  uint32_t variable_record_count = 0;
  std::vector<std::string> records;

  [[nodiscard]] std::string text() const;
  /// A zeroed record of the format's length with X, Y and Z.
  [[nodiscard]] Bytes record(int32_t x, int32_t y, int32_t z) const;
};

inline int las_record_bytes(int format) {
  constexpr int kBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  return kBytes[format];
}

inline Bytes LasFile::record(int32_t x, int32_t y, int32_t z) const {
  Bytes bytes(std::string(static_cast<size_t>(las_record_bytes(format) + extra_bytes), '\0'));
  return bytes.set(0, x).set(4, y).set(8, z);
}

inline std::string LasFile::text() const {
  const auto header_size = static_cast<uint16_t>(minor == 5 ? 393 : minor == 4 ? 375 : minor == 3 ? 235 : 227);
  const auto count = static_cast<uint32_t>(records.size());
  Bytes file(std::string(header_size, '\0'));
  file.set(0, 'L').set(1, 'A').set(2, 'S').set(3, 'F');
  file.set<uint8_t>(24, 1).set(25, static_cast<uint8_t>(minor)).set(94, header_size);
  file.set(96, static_cast<uint32_t>(header_size + variable_records.size())).set(100, variable_record_count);
  file.set(104, static_cast<uint8_t>(format));
  file.set(105, static_cast<uint16_t>(las_record_bytes(format) + extra_bytes));
  if (minor < 4) file.set(107, count);
  if (minor >= 4) file.set<uint64_t>(247, count);
  for (size_t axis = 0; axis < 3; ++axis) {
    file.set(131 + 8 * axis, scale[axis]).set(155 + 8 * axis, offset[axis]);
  }
  file.add_text(variable_records);
  for (const std::string& record : records) file.add_text(record);
  return file.text();
}

}  // namespace surfcast::testing
