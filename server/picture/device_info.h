#pragma once

#include <string>

namespace surfcast::picture {

/// The GL device that renders.
struct DeviceInfo {
  std::string vendor;
  std::string renderer;
  std::string version;
  bool software = false;  ///< a software renderer: pixels are computed on the CPU
};

}  // namespace surfcast::picture
