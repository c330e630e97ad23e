#include "laz/record_layout.h"

#include <algorithm>
#include <initializer_list>
#include <string>

#include "laz/wave_packet_decoder.h"

namespace surfcast::laz {
namespace {

/// Sizes of the item at the start of every record.
constexpr size_t kPoint10Bytes = 20;
constexpr size_t kPoint14Bytes = 30;

bool is_one_of(int point_format, std::initializer_list<int> formats) {
  return std::find(formats.begin(), formats.end(), point_format) != formats.end();
}

}  // namespace

Result<RecordLayout> record_layout(int point_format, size_t length) {
  if (point_format < 0 || point_format > 10) {
    return fail(ErrorKind::kUnsupported,
                "LAZ compressed point format " + std::to_string(point_format) + " is not supported");
  }
  RecordLayout layout;
  layout.layered = point_format >= 6;
  layout.gps_time = is_one_of(point_format, {1, 3, 4, 5});
  layout.color = is_one_of(point_format, {2, 3, 5, 7, 8, 10});
  layout.infrared = is_one_of(point_format, {8, 10});
  layout.wave_packet = is_one_of(point_format, {4, 5, 9, 10});
  layout.color_offset = layout.layered ? kPoint14Bytes : kPoint10Bytes + (layout.gps_time ? 8 : 0);
  layout.wave_offset = layout.color_offset + (layout.color ? 6 : 0) + (layout.infrared ? 2 : 0);
  layout.extra_offset = layout.wave_offset + (layout.wave_packet ? WavePacket::kBytes : 0);
  layout.length = length;
  if (length < layout.extra_offset) {
    return fail(ErrorKind::kInvalidInput, "LAZ point records of " + std::to_string(length) +
                                              " bytes are too short for point format " + std::to_string(point_format));
  }
  return layout;
}

}  // namespace surfcast::laz
