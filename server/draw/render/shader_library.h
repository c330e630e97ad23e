#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/result.h"
#include "render/embedded_shaders.h"

namespace surfcast::render {

/// The text of a shader. Its `#include "..."` lines are replaced by the named files, each once. `more` are files in
/// addition to those of shaders/. The files in shaders/kinds/ that extend shared shaders for kinds other than surfels
/// are included only if `more` is not empty; otherwise the text is that for surfels alone.
Result<std::string> shader_text(std::string_view name, std::span<const EmbeddedShader> more = {});

}  // namespace surfcast::render
