#pragma once

#include "gaussian/gaussian_source.h"

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

}  // namespace surfcast::gaussian
