#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `build-plan`, `build-part`, `build-signs`, `build-blocks` and `build-merge` to `app`. The command that is given
/// runs during parsing and sets `outcome`.
void add_build_step_commands(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
