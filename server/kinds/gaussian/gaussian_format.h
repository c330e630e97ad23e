#pragma once

#include <filesystem>
#include <optional>

#include "stream/mapped_stream.h"

namespace surfcast::gaussian {

enum class GaussianFormat { kPly, kCompressedPly, kSplat, kSpz, kSogMeta, kSogZip };

/// The format of a file, by its content; none if it does not hold Gaussians. Only .splat, which has neither header nor
/// signature, is told by its name. A zip archive is assumed to be SOG.
std::optional<GaussianFormat> gaussian_format_of(const stream::FilePtr& file, const std::filesystem::path& path);

}  // namespace surfcast::gaussian
