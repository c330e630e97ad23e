#pragma once

#include <span>
#include <string_view>

namespace surfcast::render {

struct EmbeddedShader {
  std::string_view name;  ///< path below shaders/, or the name in `#include` lines
  std::string_view text;
};

/// Every file of shaders/, generated at build time.
std::span<const EmbeddedShader> embedded_shaders();

}  // namespace surfcast::render
