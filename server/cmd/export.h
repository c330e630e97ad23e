#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `export SCAN --output FILE`: the points of a scan, or a part of them, as LAS, LAZ, PLY or CSV. The command
/// leaves how it went in `outcome`.
void add_export_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
