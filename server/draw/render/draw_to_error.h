#pragma once

#include <functional>
#include <optional>

#include "base/result.h"
#include "picture/picture.h"
#include "render/region.h"
#include "render/spacing_search.h"

namespace surfcast::render {

/// Draws a picture, or a window of it, with the pixels that it has in the whole picture.
using DrawWindow =
    std::function<Result<picture::Frame>(const picture::PictureRequest&, const std::optional<Region>& window)>;

/// Draws the picture of the spacing at which it has PictureRequest::error. It is drawn at several spacings, each of
/// which is compared, in windows, with a picture of a fourth of the spacing. Pictures of another pixel format are drawn
/// once more at the end. The frame has the expected error and time; its stage "search" is the time of all else.
/// `guess`: where the search begins; is replaced by what was found. Fails where a drawing fails.
Result<picture::Frame> draw_to_error(const picture::PictureRequest& request, const DrawWindow& draw,
                                     SpacingGuess& guess);

}  // namespace surfcast::render
