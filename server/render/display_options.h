#pragma once

#include <vector>

#include "base/result.h"
#include "model/model_file.h"
#include "picture/picture.h"
#include "residency/surfel_pool.h"
#include "shared/frame_layout.h"

namespace surfcast::render {

/// What the options of a picture come to on one model. What a picture does not ask for costs it nothing.
struct DisplayOptions {
  picture::SurfelColor color = picture::SurfelColor::kStored;
  picture::ColorMap map = picture::ColorMap::kViridis;
  double first = 0;  ///< the value that takes the first colour of the map
  double last = 1;
  int up_axis = 2;
  bool hides_classes = false;
  bool clipped = false;
  bool attributes = false;  ///< intensity or classification of each surfel is needed

  /// The colour comes from a table.
  [[nodiscard]] bool mapped() const {
    return color != picture::SurfelColor::kStored && color != picture::SurfelColor::kNormal;
  }
};

/// Fails when the model lacks the attribute that is to be shown.
Result<DisplayOptions> resolve_display_options(const model::ModelInfo& info, const picture::PictureRequest& request);

/// The colours of Look::mapped, packed as splats have them: of a map from its first to its last, or one for each class.
std::vector<uint32_t> color_table(const DisplayOptions& display);

layout::DisplayConstants display_constants(const DisplayOptions& display, const picture::PictureRequest& request);

/// What each block is asked; appends the ranges of codes that the clip comes to on it. Exactly those codes whose
/// position is in a box are in its range.
layout::BlockDisplay block_display(const DisplayOptions& display, const geometry::Clip& clip,
                                   const residency::ResidentBlock& block, std::vector<layout::ClipRange>& ranges);

}  // namespace surfcast::render
