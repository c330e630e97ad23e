#pragma once

#include "picture/device_info.h"
#include "render/renderer.h"

namespace surfcast::cmd {

/// Logs the device, the memory budgets, and a budget that is smaller than the requested one. Software rendering is
/// logged as a warning.
void log_device(const picture::DeviceInfo& device, const render::RendererConfig& asked);

}  // namespace surfcast::cmd
