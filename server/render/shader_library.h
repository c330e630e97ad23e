#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace surfcast::render {

/// The text of a shader with its `#include "..."` lines replaced by the files they name, each once.
Result<std::string> shader_text(std::string_view name);

}  // namespace surfcast::render
