#pragma once

#include <filesystem>

#include "gaussian/gaussian_source.h"
#include "gaussian/sog_files.h"

namespace surfcast::gaussian {

enum class PlyKind {
  kOther,       ///< points or a mesh
  kFloats,      ///< a number for each property: 3D Gaussians, or 2D Gaussians with two scales
  kCompressed,  ///< packed into chunks of 256
};

/// What a PLY file holds, by its header.
PlyKind ply_kind_of(std::span<const std::byte> bytes);

/// Gaussians of training programs (Kerbl et al. 2023, Huang et al. 2024): logarithms of scales, logits of opacities.
Result<SourcePtr> open_ply(const stream::FilePtr& file);

/// Compressed PLY of PlayCanvas: chunks of 256 with ranges of floats, in which vertices have integers.
Result<SourcePtr> open_compressed_ply(const stream::FilePtr& file);

/// SOG of version 2, the description in a folder (its path is for the pictures beside it) or all in a zip archive. WebP
/// is decoded picture by picture, each as a whole: 28 bytes for each Gaussian are held, and limited.
Result<SourcePtr> open_sog_folder(const stream::FilePtr& meta, const std::filesystem::path& path,
                                  const scan::DecodingLimit& limit);
Result<SourcePtr> open_sog_zip(const stream::FilePtr& archive, const scan::DecodingLimit& limit);

/// .splat: records of 32 bytes without a header. Three floats position, three floats standard deviation, bytes red,
/// green, blue, opacity, and the rotation w x y z, (byte - 128) / 128. Always little-endian.
Result<SourcePtr> open_splat(const stream::FilePtr& file);

/// True for SPZ: in the clear (version 4), or packed by gzip.
[[nodiscard]] bool looks_like_spz(const stream::FilePtr& file);

/// SPZ, versions 2 and 3 (one gzip stream) and 4 (a zstd stream for each column). Columns follow each other, so that
/// each is read by a decoder of its own and rows need no more memory than is asked for.
Result<SourcePtr> open_spz(const stream::FilePtr& file);

}  // namespace surfcast::gaussian
