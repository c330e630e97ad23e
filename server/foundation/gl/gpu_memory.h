#pragma once

#include <cstdint>
#include <optional>

namespace surfcast::gl {

/// Bytes that are free on the GPU at the moment, by GL_NVX_gpu_memory_info or GL_ATI_meminfo; none where the driver
/// states neither. Needs the current GL context.
std::optional<uint64_t> free_gpu_memory();

}  // namespace surfcast::gl
