#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `inspect MODEL [--json] [--verify]`: what is in a model. The command leaves how it went in `outcome`.
void add_inspect_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
