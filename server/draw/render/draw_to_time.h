#pragma once

#include <functional>
#include <optional>

#include "base/result.h"
#include "picture/picture.h"
#include "render/time_search.h"

namespace surfcast::render {

/// Draws a picture.
using DrawPicture = std::function<Result<picture::Frame>(const picture::PictureRequest&)>;

/// Draws the picture of the finest spacing that is drawn in PictureRequest::time_ms: at several spacings, and returns
/// the best. The frame has its time as the expected one; its stage "search" is the time of the others. Loading blocks
/// does not count. `known`: a picture of the model from which the search begins; is replaced by what was found. Fails
/// where a drawing fails.
Result<picture::Frame> draw_to_time(const picture::PictureRequest& request, const DrawPicture& draw,
                                    std::optional<SpacingTime>& known);

}  // namespace surfcast::render
