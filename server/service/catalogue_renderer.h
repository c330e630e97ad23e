#pragma once

#include "render/renderer.h"
#include "service/frame_renderer.h"
#include "service/model_catalogue.h"

namespace surfcast::service {

/// Makes renderers that draw the models of a catalogue, which must outlive them, with the renderer.
FrameRendererFactory catalogue_renderers(const ModelCatalogue& models, const render::RendererConfig& config);

}  // namespace surfcast::service
