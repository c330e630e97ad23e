#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "scattered/field_options.h"

namespace surfcast::cmd {

/// `--value` and the flags that need it: points that are samples of a field. `field` must outlive the parsing.
void add_field_flags(CLI::App& command, std::optional<scattered::FieldOptions>& field);

}  // namespace surfcast::cmd
