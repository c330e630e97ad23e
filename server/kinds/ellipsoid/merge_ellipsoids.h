#pragma once

#include <cstddef>

#include "ellipsoid/ellipsoids.h"

namespace surfcast::ellipsoid {

/// The cubes of a coarser level.
struct MergeRule {
  bool on_grid = true;   ///< Ellipsoids::samples are those of a grid, which fill it
  double step = 1;       ///< the side of cubes of level 0, world units: the least step of the grid, or of the lattice
  double scale = 1;      ///< semi-axis of a value of 1, world units
  int first_level = 1;   ///< the least level of the cubes
  int widest_level = 1;  ///< no higher one is taken for the sake of fewer than `most`
  size_t most = 1;       ///< ellipsoids that may be left
};

/// Fewer ellipsoids for a coarser level, and the side of the cubes whose ellipsoids became one, world units.
struct MergedEllipsoids {
  Ellipsoids ellipsoids;
  double side = 0;
};

/// Merges the ellipsoids in each cube of 2^level samples a side: mean centre, colour (of linear light) and scalars, and
/// the mean tensor R diag(values) R^T, each weighted by the number of ellipsoids that stand behind. The level is at
/// least the rule's first and one more than that of the ellipsoids, and so high that at most `most` and at most 0.3 of
/// them are left.
///
/// n ellipsoids of a cube that a grid fills with 8^level have the projected area of n / 2^level, since others hide
/// behind them. The factor of the merged one is 1.25 sqrt(n / 2^level), for a level of 1 the measured 2.5 sqrt(n / 8);
/// beside a grid, where nothing is known of the filling, 1.25 n^(1/3), which is the same for full cubes. One that is
/// alone in its cube stays as it is, and so does one off a grid that is larger than its cube.
[[nodiscard]] MergedEllipsoids merge_ellipsoids(const Ellipsoids& ellipsoids, const MergeRule& rule);

/// The most that the factor of a merged ellipsoid can be that stands for so many.
[[nodiscard]] double largest_factor(double count);

/// Appends all ellipsoids of another list with the same columns, or with scalars of other types: they become floats.
void append_all(const Ellipsoids& from, Ellipsoids& to);

}  // namespace surfcast::ellipsoid
