#pragma once

#include "gaussian/gaussian_codes.h"
#include "geometry/box.h"

namespace surfcast::gaussian {

/// Appends Gaussian i of another list.
void append(const Gaussians& from, size_t i, Gaussians& to);

/// Fewer Gaussians for a coarser level, and the side of the cubes whose Gaussians became one.
struct MergedGaussians {
  Gaussians gaussians;
  double side = 0;  ///< world units
};

/// Merges the Gaussians in each cube of a lattice that begins at the lower corner of a cell. The cubes are 1/512 of
/// the cell's side, or so many times twice as wide that at most `most` Gaussians and at most 0.3 of them are left, but
/// not wider than 1/8 of it while `most` is kept. Gaussians with a deviation longer than a cube stay as they are.
///
/// With the weights w = alpha A, where A is the mean area of an ellipsoid's projections: the mean, the covariance
/// sum w (V + delta delta^T) / sum w, the mean colour by w, and alpha = 1 - exp(-sum alpha_i A_i / A). Adding areas
/// where Gaussians lie side by side is what drawing all of them does not: their transparencies would multiply.
MergedGaussians merge_gaussians(const Gaussians& gaussians, const BlockTraits& traits, const geometry::Box& cell,
                                size_t most);

}  // namespace surfcast::gaussian
