#pragma once

#include <cstddef>

#include "base/result.h"

namespace surfcast::laz {

/// The items of the records of a point format.
struct RecordLayout {
  bool layered = false;   ///< point formats 6 to 10: each field of a chunk is coded separately
  bool gps_time = false;  ///< as a separate item, at byte 20
  bool color = false;
  bool infrared = false;  ///< after the colour
  bool wave_packet = false;
  size_t color_offset = 0;
  size_t wave_offset = 0;
  size_t extra_offset = 0;  ///< start of the extra bytes, which belong to no other item
  size_t length = 0;

  [[nodiscard]] size_t extra_bytes() const { return length - extra_offset; }
};

/// Fails for unknown point formats, and if the length is too short for the format.
Result<RecordLayout> record_layout(int point_format, size_t length);

}  // namespace surfcast::laz
