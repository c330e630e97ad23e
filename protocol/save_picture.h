#pragma once

#include <functional>
#include <string>

#include "base/result.h"
#include "protocol/request_flags.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// What an answered picture shows and took, as JSON. Its "camera" is what --camera reads.
std::string picture_stats_json(const wire::Picture& picture);

/// Writes an answered picture to `output` ("-": standard output) and its figures to `stats` (empty: nowhere). Files
/// appear whole or not at all.
Status save_picture(const wire::Picture& picture, const std::string& output, const std::string& stats);

/// Asks `draw` for the picture of the flags, or for each frame of their path, and saves what it gives.
Status draw_and_save(const RequestFlags& flags, const wire::DrawPicture& picture,
                     const std::function<Result<wire::Picture>(const wire::DrawPicture&)>& draw);

}  // namespace surfcast::protocol
