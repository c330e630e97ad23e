#pragma once

#include <string_view>

#include "surfcast.pb.h"

namespace surfcast::protocol {

// Display options with a structure, set from their texts. False when the text is no value of the option: then the
// picture stays as it was.

bool set_color_source(wire::DrawPicture& picture, std::string_view text);
bool set_color_range(wire::DrawPicture& picture, std::string_view text);
bool set_hidden_classes(wire::DrawPicture& picture, std::string_view text);
bool set_hidden_models(wire::DrawPicture& picture, std::string_view text);
bool set_class_opacities(wire::DrawPicture& picture, std::string_view text);
/// Replaces the boxes that are not inverted, and keeps the others.
bool set_boxes_to_show(wire::DrawPicture& picture, std::string_view text);
/// Replaces the inverted boxes, and keeps the others.
bool set_boxes_to_hide(wire::DrawPicture& picture, std::string_view text);
bool set_eye_dome(wire::DrawPicture& picture, std::string_view text);

}  // namespace surfcast::protocol
