#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "base/result.h"
#include "gl/objects.h"

namespace surfcast::gl {

/// One stage of a program. `source` is the text after #version.
struct StageSource {
  GLenum stage;
  std::string_view name;  ///< for messages
  std::string_view source;
};

/// Compiles and links a program. `defines` is text such as "#define LIT 1\n" and is placed before every source. The
/// error message of a failure contains the driver's log.
Result<Program> make_program(const char* label, std::initializer_list<StageSource> stages,
                             const std::string& defines = {});

}  // namespace surfcast::gl
