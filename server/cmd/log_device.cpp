#include "cmd/log_device.h"

#include "base/log.h"

namespace surfcast {

void log_device(const DeviceInfo& device) {
  spdlog::info("OpenGL {} by {}: {}", device.version, device.vendor, device.renderer);
  if (device.software) spdlog::warn("no GPU: pictures are drawn in software, which is slow");
}

}  // namespace surfcast
