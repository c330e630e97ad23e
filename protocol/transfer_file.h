#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Parses a transfer function: {"points": [{"value": V, "color": [R, G, B], "opacity": O}, ...]} with ascending values,
/// sRGB colours of 0 to 255 and opacities of one spacing of the grid, or {"preset": "ct-bone", "first": V, "last": V}.
/// `transfer` keeps its content on failure.
Status parse_transfer_json(std::string_view text, wire::TransferFunction& transfer);

/// The same from a file. Errors name it.
Status read_transfer_file(const std::string& path, wire::TransferFunction& transfer);

}  // namespace surfcast::protocol
