#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `render MODEL --output OUT ...`: one picture of a model or a scan without a socket, by the code of `serve`. The
/// command leaves how it went in `outcome`.
void add_render_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
