#pragma once

#include <cstdint>
#include <optional>

namespace surfcast::gl {

/// Bytes that are free on the GPU at the moment, by GL_NVX_gpu_memory_info or GL_ATI_meminfo; none where the driver
/// states neither. Needs the current GL context.
std::optional<uint64_t> free_gpu_memory();

/// Whether a value of glGetGraphicsResetStatus says that a reset of the GPU has
/// taken the context's objects. Drivers also return values that the
/// specification does not know; these say nothing.
bool is_reset(uint32_t status);

/// Whether that has happened to the current context. It is of no use any more
/// then.
bool context_was_reset();

}  // namespace surfcast::gl
