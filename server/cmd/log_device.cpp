#include "cmd/log_device.h"

#include "base/log.h"

namespace surfcast::cmd {

void log_device(const picture::DeviceInfo& device) {
  spdlog::info("OpenGL {} by {}: {}", device.version, device.vendor, device.renderer);
  if (device.software) spdlog::warn("no GPU: pictures are drawn in software, which is slow");
}

}  // namespace surfcast::cmd
