#pragma once

#include <functional>

#include "render/renderer.h"
#include "service/frame_renderer.h"
#include "service/model_catalogue.h"

namespace surfcast::service {

/// A factory of renderers for the models of a catalogue. The catalogue must outlive the factory and its renderers.
/// `on_reset` is called on the render thread once a reset of the GPU has ended drawing for good.
FrameRendererFactory catalogue_renderers(
    const ModelCatalogue& models, const render::RendererConfig& config, std::function<void()> on_reset = [] {});

}  // namespace surfcast::service
