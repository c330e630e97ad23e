#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/preemption.h"
#include "base/result.h"
#include "picture/device_info.h"
#include "picture/picture.h"

namespace surfcast::service {

/// Draws pictures of models by name. Created, used and destroyed on the render thread.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;

  /// Returns kCancelled soon after it is cancelled. More urgent work may draw one other picture at a time meanwhile.
  virtual Result<picture::Frame> draw(const std::string& model, const picture::PictureRequest& request,
                                      const Preemption& preemption) = 0;
  /// Called while no job waits: does one step of work that would delay later pictures. False when no work remains. A
  /// step ends soon after it is cancelled, and is done again by the next call.
  virtual bool warm_up(const Preemption& preemption) = 0;
  [[nodiscard]] virtual const picture::DeviceInfo& device() const = 0;
  /// Largest side of a picture, pixels.
  [[nodiscard]] virtual int max_resolution() const = 0;
};

/// Called on the render thread.
using FrameRendererFactory = std::function<Result<std::unique_ptr<FrameRenderer>>()>;

}  // namespace surfcast::service
