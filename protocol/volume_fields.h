#pragma once

#include <optional>
#include <string_view>

#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Sets one option of volumes in a picture request: transfer, shaded, iso, slice, medium or opacity. False when `name`
/// is none of them or `text` is not a valid value.
bool set_volume_field(wire::DrawPicture& picture, std::string_view name, std::string_view text);

/// The preset of that name: "ct-bone".
std::optional<wire::TransferPreset> parse_transfer_preset(std::string_view name);

}  // namespace surfcast::protocol
