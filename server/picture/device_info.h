#pragma once

#include <string>

namespace surfcast::picture {

/// The GL device that draws.
struct DeviceInfo {
  std::string vendor;
  std::string renderer;
  std::string version;
  bool software = false;  ///< pixels are computed by the CPU
};

}  // namespace surfcast::picture
