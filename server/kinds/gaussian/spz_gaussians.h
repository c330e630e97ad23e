#pragma once

#include "gaussian/gaussian_source.h"

namespace surfcast::gaussian {

/// True for SPZ: in the clear (version 4), or packed by gzip.
[[nodiscard]] bool looks_like_spz(const stream::FilePtr& file);

/// SPZ, versions 2 and 3 (one gzip stream) and 4 (a zstd stream for each column). Columns follow each other, so that
/// each is read by a decoder of its own and rows need no more memory than is asked for.
Result<SourcePtr> open_spz(const stream::FilePtr& file);

}  // namespace surfcast::gaussian
