#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/result.h"
#include "render/embedded_shaders.h"

namespace surfcast::render {

/// The text of a shader with its `#include "..."` lines replaced by the files they name, each once. `more` are files
/// besides those of shaders/. What other kinds than surfels add to shared shaders lies in shaders/kinds/: without
/// `more` these includes are left out, and the text is that of surfels alone.
Result<std::string> shader_text(std::string_view name, std::span<const EmbeddedShader> more = {});

}  // namespace surfcast::render
