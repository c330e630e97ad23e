#pragma once

#include <string_view>

#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Sets one of the fields of a picture that say what is shown of a model and in which colours: color_by, color_map,
/// color_range, hide_classes, clip_box, clip_out, eye_dome. False when the name is none of them or the text does not
/// fit it.
bool set_display_field(wire::DrawPicture& picture, std::string_view name, std::string_view text);

}  // namespace surfcast::protocol
