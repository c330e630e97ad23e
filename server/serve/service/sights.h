#pragma once

#include <vector>

#include "kinds/glyph_sight.h"
#include "kinds/volume_sight.h"
#include "model/model_file.h"
#include "picture/picture.h"

namespace surfcast::service {

/// What a picture shows of each volume of a model.
std::vector<kinds::VolumeSight> volume_sights(const model::ModelFile& model, const picture::PictureRequest& request);

/// What a picture shows of the ellipsoids of a model.
struct GlyphSights {
  std::vector<kinds::GlyphSight> sights;  ///< of each source
  double reach = 0;                       ///< the longest semi-axis of all, world units
};

GlyphSights glyph_sights(const model::ModelFile& model, const picture::PictureRequest& request);

}  // namespace surfcast::service
