#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace surfcast::scan {

/// Neighbours of a point whose spread is compared: on a surface both sets are flat.
inline constexpr size_t kNearNeighbours = 12;
inline constexpr size_t kWideNeighbours = 32;

/// What a point stands for.
enum class PointKind : uint8_t {
  kSurface,  ///< an oriented disc
  kScatter,  ///< lies on no surface (leaves, strays): a round splat that faces the eye
  kThread,   ///< the same, in a line of points (wires, single scan lines)
  kStated,   ///< an oriented disc whose radius the file states
};

/// The eigenvalues of the covariance of a point and its nearest neighbours: variances along the principal axes, in any
/// common unit, ascending.
struct Spread {
  double least = 0;
  double middle = 0;
  double largest = 0;
};

/// True if the neighbourhood is a piece of a surface: flat with kWideNeighbours, no line there, and flat with
/// kNearNeighbours as well, unless these lie on a line (a scan line has no plane of its own). docs/kernel.md has
/// measurements.
bool lies_on_surface(const Spread& near, const Spread& wide);

/// True if it is so flat that chance does not make it so in a volume: the spacing of the surfaces around is theirs.
bool lies_on_clear_surface(const Spread& near, const Spread& wide);

/// True if either neighbourhood is a line.
bool lies_on_line(const Spread& near, const Spread& wide);

constexpr bool is_scatter(PointKind kind) {
  return kind == PointKind::kScatter || kind == PointKind::kThread;
}

/// The radius of a splat off the surface before its limit, in the unit of `third`, the distance to the third nearest
/// neighbour. On average it is half the distance to the nearest one; paired echoes do not affect it.
double scatter_radius(double third);

/// What each surfel is, and its radius, as far as its surroundings tell.
struct Estimates {
  std::vector<float> radii;      ///< world units, before their limits
  std::vector<PointKind> kinds;  ///< kStated: the file's radius is kept, whatever the surroundings are
};

/// The radius of a point of this kind where the surfaces around have the radius `around`.
double limited_radius(PointKind kind, double radius, double around);

}  // namespace surfcast::scan
