#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `serve [PATH...] [--listen HOST:PORT] [--gpu N] ...`: serves models until SIGINT or SIGTERM. The command leaves
/// how it went in `outcome`.
void add_serve_command(CLI::App& app, Status& outcome);

/// Adds `healthcheck [--url HOST:PORT]`: whether a server answers there.
void add_healthcheck_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
