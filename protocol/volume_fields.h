#pragma once

#include <optional>
#include <string_view>

#include "surfcast.pb.h"

namespace surfcast::protocol {

// Options of volumes with a structure, set from their texts. False when the text is no value of the option: then the
// picture stays as it was.

bool set_transfer(wire::DrawPicture& picture, std::string_view text);
bool set_iso_surfaces(wire::DrawPicture& picture, std::string_view text);
bool set_slices(wire::DrawPicture& picture, std::string_view text);

/// The preset of that name: "ct-bone".
std::optional<wire::TransferPreset> parse_transfer_preset(std::string_view name);

}  // namespace surfcast::protocol
