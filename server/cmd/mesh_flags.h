#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "builder/mesh_input.h"

namespace surfcast::cmd {

/// `--mesh-spacing`, `--mesh-surfels` and `--faces`: how meshes become surfels. `options` keep their values where a
/// flag is not given, and must outlive the parsing.
void add_mesh_flags(CLI::App& command, builder::MeshOptions& options);

/// The flags that ask for these options; none for the defaults.
std::vector<std::string> arguments_of(const builder::MeshOptions& options);

}  // namespace surfcast::cmd
