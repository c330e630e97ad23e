#pragma once

#include <vector>

#include "base/result.h"
#include "model/model_file.h"
#include "picture/picture.h"
#include "render/volume_plan.h"
#include "residency/block_pool.h"
#include "shared/frame_layout.h"

namespace surfcast::render {

/// How surfels are seen through.
struct SeenThrough {
  bool any = false;       ///< they are
  bool by_file = false;   ///< their opacities are those of the scan
  bool by_class = false;  ///< their opacities depend on their classes
  bool ghosts = false;    ///< those that are clipped are drawn, too
};
SeenThrough seen_through(const model::ModelInfo& info, const picture::PictureRequest& request);

/// The display options of a picture, resolved for one model. Options that a picture does not use cost nothing.
struct DisplayOptions {
  picture::SurfelColor color = picture::SurfelColor::kStored;
  picture::ColorMap map = picture::ColorMap::kViridis;
  double first = 0;  ///< value of the map's first colour
  double last = 1;
  int up_axis = 2;
  bool hides_classes = false;
  bool clipped = false;
  SeenThrough through;
  VolumeLook volumes;
  std::vector<double> glyph_reaches;  ///< see render/glyph_plan.h
  bool attributes = false;            ///< the intensity or classification of each surfel is needed

  /// True if the colour comes from a table.
  [[nodiscard]] bool mapped() const {
    return color == picture::SurfelColor::kIntensity || color == picture::SurfelColor::kElevation ||
           color == picture::SurfelColor::kClassification || color == picture::SurfelColor::kAttribute;
  }
};

/// Fails if the model lacks the attribute to be shown.
Result<DisplayOptions> resolve_display_options(const model::ModelInfo& info, const picture::PictureRequest& request);

/// The colour table of DisplayOptions::mapped, packed as in splat records: the colours of a map from its first to its
/// last one, or one colour for each class.
std::vector<uint32_t> color_table(const DisplayOptions& display);

/// The opacities of ghosts and classes.
layout::ThroughConstants through_constants(const picture::PictureRequest& request);

layout::DisplayConstants display_constants(const DisplayOptions& display, const picture::PictureRequest& request);

/// The parameters of a block for the display options. Appends the ranges of its position codes that the clip boxes
/// cover. A range contains exactly the codes whose positions lie in the box.
layout::BlockDisplay block_display(const DisplayOptions& display, const geometry::Clip& clip,
                                   const residency::ResidentBlock& block, std::vector<layout::ClipRange>& ranges);

}  // namespace surfcast::render
