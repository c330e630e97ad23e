#pragma once

#include "picture/device_info.h"

namespace surfcast::cmd {

/// Says what draws. Software rendering is announced, never silent.
void log_device(const picture::DeviceInfo& device);

}  // namespace surfcast::cmd
