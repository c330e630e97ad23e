#pragma once

#include <memory>
#include <string>

#include "base/result.h"

namespace surfcast::gl {

/// A current OpenGL 4.5 core context without a window. Belongs to the thread that created it.
///
/// The device is chosen so: the one asked for; else the first hardware device of EGL_EXT_device_enumeration that gives
/// a context (NVIDIA's EGL, or a DRM device of Mesa); else Mesa's surfaceless platform, which computes on the CPU.
class EglContext {
 public:
  /// `gpu` is an index into the EGL devices of the machine; -1 chooses.
  static Result<std::unique_ptr<EglContext>> create(int gpu);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  [[nodiscard]] const std::string& vendor() const { return vendor_; }
  [[nodiscard]] const std::string& renderer() const { return renderer_; }
  [[nodiscard]] const std::string& version() const { return version_; }
  /// True when pixels are computed by the CPU.
  [[nodiscard]] bool software() const { return software_; }

 private:
  EglContext(void* display, void* context);

  void* display_;
  void* context_;
  std::string vendor_;
  std::string renderer_;
  std::string version_;
  bool software_ = false;
};

}  // namespace surfcast::gl
