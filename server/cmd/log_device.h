#pragma once

#include "picture/device_info.h"

namespace surfcast::cmd {

/// Says what draws, in how much memory, and where that is less than was asked for. Software rendering is announced,
/// never silent.
void log_device(const picture::DeviceInfo& device, const render::RendererConfig& asked);

}  // namespace surfcast::cmd
