#pragma once

namespace surfcast {

/// From here on the calling thread gets only processor time that nothing else wants.
void work_in_idle_time();

}  // namespace surfcast
