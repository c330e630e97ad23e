#pragma once

#include <functional>

#include "render/renderer.h"
#include "service/model_renderer.h"

namespace surfcast::service {

/// A factory of renderers in this process. `on_reset` is called on the render thread once a reset of the GPU has ended
/// drawing for good.
ModelRendererFactory local_renderers(
    const render::RendererConfig& config, std::function<void()> on_reset = [] {});

}  // namespace surfcast::service
