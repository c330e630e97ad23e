#pragma once

#include "render/renderer.h"

namespace surfcast {

/// Says what draws. Software rendering is announced, never silent.
void log_device(const DeviceInfo& device);

}  // namespace surfcast
