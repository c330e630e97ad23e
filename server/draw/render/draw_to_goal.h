#pragma once

#include <functional>
#include <optional>
#include <string_view>

#include "base/result.h"
#include "picture/picture.h"
#include "render/region.h"
#include "render/scale_search.h"
#include "render/spacing_search.h"
#include "render/time_search.h"

namespace surfcast::render {

/// The time of drawing a frame whose blocks are there, milliseconds.
inline double drawing_ms(const picture::Frame& frame) {
  const auto loads = [](std::string_view name) { return name == "load" || name == "decode" || name == "upload"; };
  double sum = 0;
  for (const picture::StageTime& stage : frame.stats.stages) {
    if (!loads(stage.name)) sum += stage.milliseconds;
  }
  return sum;
}

/// Draws a picture, or a window of it, with the pixels that it has in the whole picture.
using DrawWindow =
    std::function<Result<picture::Frame>(const picture::PictureRequest&, const std::optional<Region>& window)>;

/// Draws the picture of the spacing at which it has PictureRequest::error. It is drawn at several spacings, each of
/// which is compared, in windows, with a picture of a fourth of the spacing. Pictures of another pixel format are drawn
/// once more at the end. The frame has the expected error and time; its stage "search" is the time of all else.
/// `guess`: where the search begins; is replaced by what was found. Fails where a drawing fails.
Result<picture::Frame> draw_to_error(const picture::PictureRequest& request, const DrawWindow& draw,
                                     SpacingGuess& guess);

/// Draws a picture.
using DrawPicture = std::function<Result<picture::Frame>(const picture::PictureRequest&)>;

/// Draws the picture of the finest spacing that is drawn in PictureRequest::time_ms: at several spacings, and returns
/// the best. Where none is fast enough, it is the largest render scale of the fastest spacing. The frame has its time
/// as the expected one; its stage "search" is the time of the others. Loading blocks does not count. `known`: a picture
/// of the model from which the search begins; is replaced by what was found. Fails where a drawing fails.
Result<picture::Frame> draw_to_time(const picture::PictureRequest& request, const DrawPicture& draw,
                                    std::optional<SpacingTime>& known);

}  // namespace surfcast::render
