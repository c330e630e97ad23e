#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::client {

// Each function adds one command, which stores its result in `outcome`. `interrupt` is as in ClientConfig.

/// `models URL [--json]`: the names of the served models, one per line.
void add_models_command(CLI::App& app, int interrupt, Status& outcome);
/// `login URL`: keeps a token for a server, or forgets it.
void add_login_command(CLI::App& app, int interrupt, Status& outcome);
/// `render URL/MODEL --output OUT ...`: one picture.
void add_render_command(CLI::App& app, int interrupt, Status& outcome);
/// `bench URL/MODEL ...`: frame rates, latencies and bytes of views that alternately move and rest.
void add_bench_command(CLI::App& app, int interrupt, Status& outcome);
/// `pick URL/MODEL --pixel X,Y ...`: the surfel at a pixel.
void add_pick_command(CLI::App& app, int interrupt, Status& outcome);
/// `profile URL/MODEL --line ... --width W --output FILE`: the points in a band along a line.
void add_profile_command(CLI::App& app, int interrupt, Status& outcome);
/// `export URL/MODEL --output FILE ...`: the points of a region.
void add_export_command(CLI::App& app, int interrupt, Status& outcome);
/// `view URL/MODEL ...`: an interactive window; runs the program surfcast-view.
void add_view_command(CLI::App& app, Status& outcome);
/// `ping URL [--count N]`: round trip times.
void add_ping_command(CLI::App& app, int interrupt, Status& outcome);

}  // namespace surfcast::client
