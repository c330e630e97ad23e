#pragma once

#include <CLI/CLI.hpp>

#include "base/result.h"

namespace surfcast::cmd {

/// Adds `build INPUT... --output MODEL.surf [--memory SIZE] [--precision METRES] [--report FILE.json]`: scans to a
/// model. The command leaves how it went in `outcome`.
void add_build_command(CLI::App& app, Status& outcome);

/// Adds `build-plan`, `build-part`, `build-signs`, `build-blocks` and `build-merge` to `app`. The command that is given
/// runs during parsing and sets `outcome`.
void add_build_step_commands(CLI::App& app, Status& outcome);

/// Adds `colorize SCAN... --orthophoto PHOTO --output MODEL.surf`: a model of scans with the colours of a picture from
/// above. The command leaves how it went in `outcome`.
void add_colorize_command(CLI::App& app, Status& outcome);

/// Adds `export SCAN --output FILE`: the points of a scan, or a part of them, as LAS, LAZ, PLY or CSV. The command
/// leaves how it went in `outcome`.
void add_export_command(CLI::App& app, Status& outcome);

/// The name of the command `gpus`, and a word of its lines.
inline constexpr const char* kGpusCommand = "gpus";
inline constexpr const char* kHardwareDevice = "hardware";

/// Adds `gpus`: a line for each EGL device, "0 hardware: NAME". The command leaves how it went in `outcome`.
void add_gpus_command(CLI::App& app, Status& outcome);

/// Adds `inspect MODEL [--json] [--verify]`: what is in a model. The command leaves how it went in `outcome`.
void add_inspect_command(CLI::App& app, Status& outcome);

/// `pick MODEL --pixel X,Y ...`: what a pixel of a picture shows, without a server.
void add_pick_command(CLI::App& app, Status& outcome);

/// Adds `render MODEL --output OUT ...`: one picture of a model or a scan without a socket, by the code of `serve`. The
/// command leaves how it went in `outcome`.
void add_render_command(CLI::App& app, Status& outcome);

/// Adds `serve [PATH...] [--listen HOST:PORT] [--gpu N,...|all] ...`: serves models until SIGINT or SIGTERM. The
/// command leaves how it went in `outcome`.
void add_serve_command(CLI::App& app, Status& outcome);

/// Adds `healthcheck [--url HOST:PORT]`: whether a server answers there.
void add_healthcheck_command(CLI::App& app, Status& outcome);

/// Adds `token add|list|revoke`, which edits the file of `serve --tokens`. The command leaves how it went in `outcome`.
void add_token_command(CLI::App& app, Status& outcome);

}  // namespace surfcast::cmd
