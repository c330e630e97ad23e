#pragma once

#include <functional>
#include <memory>

#include "base/preemption.h"
#include "base/result.h"
#include "model/model_file.h"
#include "picture/device_info.h"
#include "picture/picture.h"

namespace surfcast::service {

/// Draws pictures of open models, in this process or in another one. Created, used and destroyed on the render thread.
class ModelRenderer {
 public:
  virtual ~ModelRenderer() = default;

  /// Returns kCancelled soon after it is cancelled. More urgent work may draw one other picture at a time meanwhile.
  virtual Result<picture::Frame> draw(const std::shared_ptr<const model::ModelFile>& model,
                                      const picture::PictureRequest& request, const Preemption& preemption) = 0;
  /// Releases what is kept of a model that will not be drawn again.
  virtual void release_model(const model::ModelFile& model) = 0;
  [[nodiscard]] virtual const picture::DeviceInfo& device() const = 0;
  /// Largest side of a picture, pixels.
  [[nodiscard]] virtual int max_resolution() const = 0;
};

/// Called on the render thread.
using ModelRendererFactory = std::function<Result<std::unique_ptr<ModelRenderer>>()>;

}  // namespace surfcast::service
