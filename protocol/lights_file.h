#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// Parses lights: {"ambient": A, "specular": S, "exponent": E, "lights": [{"direction": [X, Y, Z], "power": P}, ...]}.
/// Without them ambient and specular light are 0, the exponent is 32 and the power of a light 1. `lighting` keeps its
/// content on failure.
Status parse_lights_json(std::string_view text, wire::Lighting& lighting);

/// The same from a file. Errors name it.
Status read_lights_file(const std::string& path, wire::Lighting& lighting);

}  // namespace surfcast::protocol
