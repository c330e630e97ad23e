#pragma once

#include <CLI/CLI.hpp>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "isosurface/iso_surface.h"

namespace surfcast::cmd {

/// Parses `VALUE`, `VALUE,R,G,B` or `VALUE,R,G,B,OPACITY`; the colour is 0 to 255 in each channel. Surfels are opaque,
/// so that an opacity other than 1 is refused.
Result<isosurface::IsoSurface> parse_iso_surface(std::string_view text);

/// `--iso`, which may be given several times. Appends to `surfaces`, which must outlive the parsing.
CLI::Option* add_iso_flag(CLI::App& command, std::vector<isosurface::IsoSurface>& surfaces);

}  // namespace surfcast::cmd
