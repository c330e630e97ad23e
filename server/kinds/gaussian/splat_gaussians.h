#pragma once

#include "gaussian/gaussian_source.h"

namespace surfcast::gaussian {

/// .splat: records of 32 bytes without a header. Three floats position, three floats standard deviation, bytes red,
/// green, blue, opacity, and the rotation w x y z, (byte - 128) / 128. Always little-endian.
Result<SourcePtr> open_splat(const stream::FilePtr& file);

}  // namespace surfcast::gaussian
