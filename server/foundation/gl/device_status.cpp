#include "gl/device_status.h"

#include <array>

#include <epoxy/gl.h>

namespace surfcast::gl {
namespace {

/// Both extensions count in KiB. A figure that is not positive is none.
std::optional<uint64_t> bytes_of(GLint kibibytes) {
  return kibibytes > 0 ? std::optional(uint64_t{static_cast<uint32_t>(kibibytes)} << 10) : std::nullopt;
}

}  // namespace

std::optional<uint64_t> free_gpu_memory() {
  if (epoxy_has_gl_extension("GL_NVX_gpu_memory_info")) {
    GLint free = 0;
    glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX, &free);
    return bytes_of(free);
  }
  if (epoxy_has_gl_extension("GL_ATI_meminfo")) {
    std::array<GLint, 4> pool{};  // free in all, largest free block, and the same of host memory
    glGetIntegerv(GL_VBO_FREE_MEMORY_ATI, pool.data());
    return bytes_of(pool[0]);
  }
  return std::nullopt;
}

bool is_reset(uint32_t status) {
  return status == GL_GUILTY_CONTEXT_RESET || status == GL_INNOCENT_CONTEXT_RESET || status == GL_UNKNOWN_CONTEXT_RESET;
}

bool context_was_reset() {
  return is_reset(glGetGraphicsResetStatus());
}

}  // namespace surfcast::gl
