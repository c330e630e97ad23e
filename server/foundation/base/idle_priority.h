#pragma once

namespace surfcast {

/// Puts the calling thread into the scheduler's idle class: it runs only while a processor has nothing else to do.
void use_idle_priority();

/// Whether the calling thread is in that class.
[[nodiscard]] bool has_idle_priority();

}  // namespace surfcast
