#pragma once

#include <string_view>

#include "base/result.h"
#include "gaussian/gaussian_codes.h"
#include "model/block_encoder.h"
#include "model/model_file.h"

namespace surfcast::gaussian {

/// The kind of blocks of Gaussians in model files.
inline constexpr std::string_view kGaussianKind = "gaussian";
/// Lattice indices within a block stay below 2^kPositionBits.
inline constexpr int kPositionBits = 20;
/// What is drawn of a Gaussian ends this many deviations from its centre.
inline constexpr double kDrawnDeviations = 5;

/// Encodes Gaussians, given in a spatial order, as one block. The lattice passes through the origin; its step is the
/// largest power of two that moves no more than one Gaussian in fifty by more than 1/128 of its middle deviation, but
/// not finer than the block's extent by 2^20. The spacing is that of neighbours along the path of the rows.
model::EncodedBlock encode_gaussians(const Gaussians& gaussians, const BlockTraits& traits);

/// A decoded block.
struct GaussianBlock {
  GaussianCodes codes;
  surfel::Grid grid;
  glm::i64vec3 origin{0};
  glm::u32vec3 extent{0};

  /// World coordinates of a Gaussian.
  [[nodiscard]] glm::dvec3 position(size_t i) const { return grid.position(origin + glm::i64vec3(codes.positions[i])); }
};

/// Checks and decodes a block. Fails on bytes that hold anything else than the table states.
Result<GaussianBlock> decode_gaussians(const model::StoredBlock& stored);

}  // namespace surfcast::gaussian
