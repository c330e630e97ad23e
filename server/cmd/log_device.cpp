#include "cmd/log_device.h"

#include "base/log.h"
#include "cmd/settings.h"

namespace surfcast::cmd {

void log_device(const picture::DeviceInfo& device, const render::RendererConfig& asked) {
  spdlog::info("OpenGL {} by {}: {}", device.version, device.vendor, device.renderer);
  if (device.software) spdlog::warn("no GPU: pictures are drawn in software, which is slow");
  spdlog::info("memory: {} for surfels on the GPU{}, {} for decoded blocks", size_text(device.memory.gpu),
               device.software ? " (the host's, in software)" : "", size_text(device.memory.host));
  if (asked.gpu_bytes.value_or(0) > device.memory.gpu) {
    spdlog::warn("--gpu-memory {}: the device holds no more than {} of surfels", size_text(*asked.gpu_bytes),
                 size_text(device.memory.gpu));
  }
}

}  // namespace surfcast::cmd
