#pragma once

#include "service/frame_renderer.h"
#include "service/model_catalogue.h"
#include "service/model_renderer.h"

namespace surfcast::service {

/// A factory of renderers for the models of a catalogue. The catalogue must outlive the factory and its renderers.
FrameRendererFactory catalogue_renderers(const ModelCatalogue& models, ModelRendererFactory make_renderer);

}  // namespace surfcast::service
