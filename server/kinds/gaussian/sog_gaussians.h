#pragma once

#include <filesystem>

#include "gaussian/gaussian_source.h"
#include "gaussian/sog_files.h"

namespace surfcast::gaussian {

/// SOG of version 2, the description in a folder (its path is for the pictures beside it) or all in a zip archive. WebP
/// is decoded picture by picture, each as a whole: 28 bytes for each Gaussian are held, and limited.
Result<SourcePtr> open_sog_folder(const stream::FilePtr& meta, const std::filesystem::path& path,
                                  const scan::DecodingLimit& limit);
Result<SourcePtr> open_sog_zip(const stream::FilePtr& archive, const scan::DecodingLimit& limit);

}  // namespace surfcast::gaussian
