#pragma once

#include <cstdint>
#include <string>

namespace surfcast::picture {

/// Memory that the renderer may use, bytes.
struct MemoryBudgets {
  uint64_t gpu = 0;   ///< for surfels on the GPU
  uint64_t host = 0;  ///< for decoded blocks that may return to the GPU
};

/// The GL device that renders.
struct DeviceInfo {
  std::string vendor;
  std::string renderer;
  std::string version;
  bool software = false;  ///< a software renderer: pixels are computed on the CPU
  /// The budgets in use: as configured or by default, and for surfels at most one buffer texture of the device.
  MemoryBudgets memory{};
};

}  // namespace surfcast::picture
