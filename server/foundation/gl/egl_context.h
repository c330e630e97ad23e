#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "base/result.h"

namespace surfcast::gl {

/// A current OpenGL 4.5 core context without a window. It belongs to the thread that created it.
///
/// The device is the requested one. Without a request it is the first hardware device of EGL_EXT_device_enumeration
/// that provides a context (NVIDIA's EGL, or a DRM device of Mesa). If there is none, Mesa's surfaceless platform is
/// used, which falls back to software rendering.
class EglContext {
 public:
  /// `gpu` is an index into the EGL devices of the machine, or -1 for the default choice. Fails with kUnavailable if
  /// there is no such device or no OpenGL 4.5 core context.
  static Result<std::unique_ptr<EglContext>> create(int gpu);
  /// How many EGL devices the machine has.
  static size_t devices();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  [[nodiscard]] const std::string& vendor() const { return vendor_; }
  [[nodiscard]] const std::string& renderer() const { return renderer_; }
  [[nodiscard]] const std::string& version() const { return version_; }
  /// True for a software renderer, which computes pixels on the CPU.
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
