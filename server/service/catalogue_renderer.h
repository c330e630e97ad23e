#pragma once

#include "render/renderer.h"
#include "service/frame_renderer.h"
#include "service/model_catalogue.h"

namespace surfcast::service {

/// A factory of renderers for the models of a catalogue. The catalogue must outlive the factory and its renderers.
FrameRendererFactory catalogue_renderers(const ModelCatalogue& models, const render::RendererConfig& config);

}  // namespace surfcast::service
