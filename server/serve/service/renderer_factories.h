#pragma once

#include <functional>

#include "render/renderer.h"
#include "service/frame_renderer.h"
#include "service/model_catalogue.h"
#include "service/model_renderer.h"

namespace surfcast::service {

/// A factory of renderers in this process. `on_reset` is called on the render thread once a reset of the GPU has ended
/// drawing for good.
ModelRendererFactory local_renderers(
    const render::RendererConfig& config, std::function<void()> on_reset = [] {});

/// Whether the shaders of a model are compiled before a picture needs them, see shader_warm_up_requests().
enum class ShaderWarmUp { kOff, kOn };

/// Of which models a renderer compiles shaders before their first pictures.
enum class ModelPlace { kAnywhere, kFile, kStore };

/// A factory of renderers for the models of a catalogue. The catalogue must outlive the factory and its renderers.
FrameRendererFactory catalogue_renderers(const ModelCatalogue& models, ModelRendererFactory make_renderer,
                                         ShaderWarmUp warm_up, ModelPlace place = ModelPlace::kAnywhere);

}  // namespace surfcast::service
