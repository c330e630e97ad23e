#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/interruption.h"
#include "base/result.h"
#include "render/picture.h"
#include "render/renderer.h"

namespace surfcast {

/// Draws pictures of models by name. Made, used and destroyed on the render thread.
class Painter {
 public:
  virtual ~Painter() = default;

  /// Returns kCancelled soon after it is interrupted for good. What is more urgent may draw one other picture at a time
  /// meanwhile.
  virtual Result<Frame> draw(const std::string& model, const PictureRequest& request,
                             const Interruption& interruption) = 0;
  /// Called while nobody waits: does something that would hold up a later picture. False when nothing is left to do.
  virtual bool rehearse() = 0;
  [[nodiscard]] virtual const DeviceInfo& device() const = 0;
  /// Largest side of a picture, pixels.
  [[nodiscard]] virtual int max_resolution() const = 0;
};

/// Called on the render thread.
using PainterFactory = std::function<Result<std::unique_ptr<Painter>>()>;

}  // namespace surfcast
