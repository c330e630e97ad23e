#pragma once

#include <functional>
#include <string>

#include "base/result.h"
#include "protocol/request_flags.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// The statistics of a picture as JSON: camera, resolution, levels, memory, milliseconds per stage. The value of
/// "camera" is in the format that --camera reads.
std::string picture_stats_json(const wire::Picture& picture);

/// Writes a picture to `output` ("-": standard output) and its statistics to `stats` (empty: none). Files are written
/// atomically.
Status save_picture(const wire::Picture& picture, const std::string& output, const std::string& stats);

/// Draws the picture that the flags describe, or each frame of their camera path, with `draw`, and saves the results:
/// as files, or as a film if the name of the output is that of one (is_film).
Status draw_and_save(const RequestFlags& flags, const wire::DrawPicture& picture,
                     const std::function<Result<wire::Picture>(const wire::DrawPicture&)>& draw);

}  // namespace surfcast::protocol
