#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "builder/mesh_input.h"
#include "estimation/stated_radii.h"
#include "isosurface/iso_surface.h"
#include "scan/selection.h"
#include "scattered/field_options.h"
#include "simplify/simplify.h"

namespace surfcast::cmd {

/// `--bounds`, `--corridor`, `--classes` and `--every`: which points of scans are read. `selection` must outlive the
/// parsing.
void add_selection_flags(CLI::App& command, scan::Selection& selection);

/// `--radii`: what a build makes of the radii that scans state. `policy` keeps its value where the flag is not given,
/// and must outlive the parsing.
CLI::Option* add_radius_flag(CLI::App& command, estimation::RadiusPolicy& policy);

/// The value of the flag that asks for a policy.
std::string name_of(estimation::RadiusPolicy policy);

/// `--mesh-spacing`, `--mesh-surfels` and `--faces`: how meshes become surfels. `options` keep their values where a
/// flag is not given, and must outlive the parsing.
void add_mesh_flags(CLI::App& command, builder::MeshOptions& options);

/// The flags that ask for these options; none for the defaults.
std::vector<std::string> arguments_of(const builder::MeshOptions& options);

/// Parses `VALUE`, `VALUE,R,G,B` or `VALUE,R,G,B,OPACITY`; the colour is 0 to 255 in each channel. Surfels are opaque,
/// so that an opacity other than 1 is refused.
Result<isosurface::IsoSurface> parse_iso_surface(std::string_view text);

/// `--iso`, which may be given several times. Appends to `surfaces`, which must outlive the parsing.
CLI::Option* add_iso_flag(CLI::App& command, std::vector<isosurface::IsoSurface>& surfaces);

/// Adds `--simplify DEGREES[,HEIGHT]`. What is wrong with a value is an error of the command line.
void add_simplify_flag(CLI::App& command, std::optional<simplify::ErrorBound>& bound);

/// `--value` and the flags that need it: points that are samples of a field. `field` must outlive the parsing.
void add_field_flags(CLI::App& command, std::optional<scattered::FieldOptions>& field);

}  // namespace surfcast::cmd
