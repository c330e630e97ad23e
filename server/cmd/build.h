#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `build INPUT... --output MODEL.surf [--memory SIZE] [--precision METRES] [--report FILE.json]`: scans to a
/// model. The command leaves how it went in `outcome`.
void add_build_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
