#pragma once

#include <cstddef>

#include "base/result.h"

namespace surfcast::laz {

/// What the records of a point format consist of.
struct RecordLayout {
  bool layered = false;   ///< point formats 6 to 8: each field of a chunk is coded apart
  bool gps_time = false;  ///< as an item of its own, at byte 20
  bool color = false;
  bool infrared = false;  ///< behind the colour
  size_t color_offset = 0;
  size_t extra_offset = 0;  ///< what no item covers are extra bytes
  size_t length = 0;

  [[nodiscard]] size_t extra_bytes() const { return length - extra_offset; }
};

/// Fails for the point formats with wave packets, and if the length is too short for the format.
Result<RecordLayout> record_layout(int point_format, size_t length);

}  // namespace surfcast::laz
