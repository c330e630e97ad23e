#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "simplify/simplify.h"

namespace surfcast::cmd {

/// Adds `--simplify DEGREES[,HEIGHT]`. What is wrong with a value is an error of the command line.
void add_simplify_flag(CLI::App& command, std::optional<simplify::ErrorBound>& bound);

}  // namespace surfcast::cmd
