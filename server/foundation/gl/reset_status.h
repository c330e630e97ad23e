#pragma once

#include <cstdint>

namespace surfcast::gl {

/// Whether a value of glGetGraphicsResetStatus says that a reset of the GPU has
/// taken the context's objects. Drivers also return values that the
/// specification does not know; these say nothing.
bool is_reset(uint32_t status);

/// Whether that has happened to the current context. It is of no use any more
/// then.
bool context_was_reset();

}  // namespace surfcast::gl
