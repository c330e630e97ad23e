#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "estimation/stated_radii.h"

namespace surfcast::cmd {

/// `--radii`: what a build makes of the radii that scans state. `policy` keeps its value where the flag is not given,
/// and must outlive the parsing.
CLI::Option* add_radius_flag(CLI::App& command, estimation::RadiusPolicy& policy);

/// The value of the flag that asks for a policy.
std::string name_of(estimation::RadiusPolicy policy);

}  // namespace surfcast::cmd
