#pragma once

#include <string_view>

#include "surfcast.pb.h"

namespace surfcast::protocol {

// Options of ellipsoids with a structure, set from their texts. False when the text is no value of the option: then the
// picture stays as it was.

bool set_glyph(wire::DrawPicture& picture, std::string_view text);
bool set_thresholds(wire::DrawPicture& picture, std::string_view text);
bool set_lights(wire::DrawPicture& picture, std::string_view text);

}  // namespace surfcast::protocol
