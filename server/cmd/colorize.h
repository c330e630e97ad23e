#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `colorize SCAN... --orthophoto PHOTO --output MODEL.surf`: a model of scans with the colours of a picture from
/// above. The command leaves how it went in `outcome`.
void add_colorize_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
