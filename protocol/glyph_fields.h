#pragma once

#include <string_view>

#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Sets the field of the look of ellipsoids that has this name. False if there is none, or if the text is not a value
/// of it: then the picture stays as it was.
bool set_glyph_field(wire::DrawPicture& picture, std::string_view name, std::string_view text);

}  // namespace surfcast::protocol
