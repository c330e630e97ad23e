#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"

namespace surfcast::cmd {

/// What `inspect` says of a file that a model can be built of, as lines of `name: value` or as JSON. Fails where the
/// file is not one, or damaged.
Result<std::string> summarize_input(const std::filesystem::path& path, bool json);

}  // namespace surfcast::cmd
