#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "base/result.h"
#include "render/picture.h"
#include "render/renderer.h"

namespace surfcast {

/// Draws pictures of models by name. Made, used and destroyed on the render thread.
class Painter {
 public:
  virtual ~Painter() = default;

  /// Returns kCancelled soon after `cancelled` becomes true.
  virtual Result<Frame> draw(const std::string& model, const PictureRequest& request,
                             const std::atomic<bool>& cancelled) = 0;
  [[nodiscard]] virtual const DeviceInfo& device() const = 0;
  /// Largest side of a picture, pixels.
  [[nodiscard]] virtual int max_resolution() const = 0;
};

/// Called on the render thread.
using PainterFactory = std::function<Result<std::unique_ptr<Painter>>()>;

}  // namespace surfcast
