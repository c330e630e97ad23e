#include "gl/reset_status.h"

#include <epoxy/gl.h>

namespace surfcast::gl {

bool is_reset(uint32_t status) {
  return status == GL_GUILTY_CONTEXT_RESET || status == GL_INNOCENT_CONTEXT_RESET || status == GL_UNKNOWN_CONTEXT_RESET;
}

bool context_was_reset() {
  return is_reset(glGetGraphicsResetStatus());
}

}  // namespace surfcast::gl
