#pragma once

#include <string>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast {

/// What an answered picture shows and took, as JSON. Its "camera" is what --camera reads.
std::string picture_stats_json(const wire::Picture& picture);

/// Writes an answered picture to `output` ("-": standard output) and its figures to `stats` (empty: nowhere). Files
/// appear whole or not at all.
Status save_picture(const wire::Picture& picture, const std::string& output, const std::string& stats);

}  // namespace surfcast
