#include "laz/record_layout.h"

#include <string>

namespace surfcast::laz {
namespace {

/// Sizes of the item at the start of every record.
constexpr size_t kPoint10Bytes = 20;
constexpr size_t kPoint14Bytes = 30;

}  // namespace

Result<RecordLayout> record_layout(int point_format, size_t length) {
  if (point_format < 0 || point_format > 8 || point_format == 4 || point_format == 5) {
    return fail(ErrorKind::kUnsupported,
                "LAZ compressed point format " + std::to_string(point_format) + " is not supported");
  }
  RecordLayout layout;
  layout.layered = point_format >= 6;
  layout.gps_time = point_format == 1 || point_format == 3;
  layout.color = point_format == 2 || point_format == 3 || point_format >= 7;
  layout.infrared = point_format == 8;
  layout.color_offset = layout.layered ? kPoint14Bytes : kPoint10Bytes + (layout.gps_time ? 8 : 0);
  layout.extra_offset = layout.color_offset + (layout.color ? 6 : 0) + (layout.infrared ? 2 : 0);
  layout.length = length;
  if (length < layout.extra_offset) {
    return fail(ErrorKind::kInvalidInput, "LAZ point records of " + std::to_string(length) +
                                              " bytes are too short for point format " + std::to_string(point_format));
  }
  return layout;
}

}  // namespace surfcast::laz
