#pragma once

namespace surfcast {

/// From here on the calling thread gets only processor time that nothing else wants.
void use_idle_priority();

}  // namespace surfcast
