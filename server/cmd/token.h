#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `token add|list|revoke`, which edits the file of `serve --tokens`. The command leaves how it went in `outcome`.
void add_token_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
