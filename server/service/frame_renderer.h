#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/preemption.h"
#include "base/result.h"
#include "picture/device_info.h"
#include "picture/picture.h"

namespace surfcast::service {

/// Draws pictures of models by name. Made, used and destroyed on the render thread.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;

  /// Returns kCancelled soon after it is interrupted for good. What is more urgent may draw one other picture at a time
  /// meanwhile.
  virtual Result<picture::Frame> draw(const std::string& model, const picture::PictureRequest& request,
                                      const Preemption& preemption) = 0;
  /// Called while nobody waits: does something that would hold up a later picture. False when nothing is left to do.
  virtual bool warm_up() = 0;
  [[nodiscard]] virtual const picture::DeviceInfo& device() const = 0;
  /// Largest side of a picture, pixels.
  [[nodiscard]] virtual int max_resolution() const = 0;
};

/// Called on the render thread.
using FrameRendererFactory = std::function<Result<std::unique_ptr<FrameRenderer>>()>;

}  // namespace surfcast::service
