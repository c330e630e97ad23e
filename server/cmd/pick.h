#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// `pick MODEL --pixel X,Y ...`: what a pixel of a picture shows, without a server.
void add_pick_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
