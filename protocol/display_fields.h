#pragma once

#include <string_view>

#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Sets one display option of a picture request: color_by, color_map, color_range, hide_classes, clip_box, clip_out or
/// eye_dome. False when `name` is not one of these or `text` is not a valid value.
bool set_display_field(wire::DrawPicture& picture, std::string_view name, std::string_view text);

}  // namespace surfcast::protocol
