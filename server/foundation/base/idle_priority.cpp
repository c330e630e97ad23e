#include "base/idle_priority.h"

#include <sched.h>

#include "base/log.h"

namespace surfcast {

void use_idle_priority() {
  const sched_param none{};
  if (sched_setscheduler(0, SCHED_IDLE, &none) != 0) spdlog::warn("a thread cannot be made an idle one");
}

bool has_idle_priority() {
  return sched_getscheduler(0) == SCHED_IDLE;
}

}  // namespace surfcast
