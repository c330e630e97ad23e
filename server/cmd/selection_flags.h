#pragma once

#include <CLI/CLI.hpp>

#include "scan/selection.h"

namespace surfcast::cmd {

/// `--bounds`, `--corridor`, `--classes` and `--every`: which points of scans are read. `selection` must outlive the
/// parsing.
void add_selection_flags(CLI::App& command, scan::Selection& selection);

}  // namespace surfcast::cmd
