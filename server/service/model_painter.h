#pragma once

#include "render/renderer.h"
#include "service/model_catalogue.h"
#include "service/painter.h"

namespace surfcast {

/// Makes painters that draw the models of a catalogue, which must outlive them, with the renderer.
PainterFactory model_painters(const ModelCatalogue& models, const RendererConfig& config);

}  // namespace surfcast
