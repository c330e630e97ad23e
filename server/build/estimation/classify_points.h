#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace surfcast::estimation {

/// Neighbours of a point whose spread is compared: on a surface both sets are flat.
inline constexpr size_t kNearNeighbours = 12;
inline constexpr size_t kWideNeighbours = 32;

/// What a point stands for.
enum class PointKind : uint8_t {
  kSurface,       ///< an oriented disc
  kRoughSurface,  ///< the same where the points are so rough that distances to neighbours are not those along a surface
  kLayer,         ///< the same, in one of the thin layers of a surface that was measured in steps of depth
  kScatter,       ///< lies on no surface (leaves, strays): a round splat that faces the eye
  kThread,        ///< the same, in a line of points (wires, single scan lines)
  kSheet,         ///< an oriented disc on a steep plane of few points beside surfaces of many
  kStated,        ///< an oriented disc whose radius the file states
};

/// The eigenvalues of the covariance of a point and its nearest neighbours: variances along the principal axes, in any
/// common unit, ascending.
struct Spread {
  double least = 0;
  double middle = 0;
  double largest = 0;
};

/// The kind of a point, from its neighbourhoods. docs/kernel.md has measurements.
/// - kSurface: flat with kWideNeighbours, no line there, and flat with kNearNeighbours as well, unless these lie on a
///   line (a scan line has no plane of its own). So flat that chance does not make it so in a volume: the spacing of
///   the surfaces around is theirs.
/// - kRoughSurface: the same, less flat.
/// - kLayer: beyond doubt flat with kNearNeighbours alone. Only a layer if is_in_layer(); otherwise scatter.
/// - kThread: neither, and either neighbourhood is a line.
/// - kScatter: everything else.
PointKind kind_of(const Spread& near, const Spread& wide);

/// True if so many of the kNearNeighbours have their plane parallel to that of the point that both are in a layer.
/// `cosines`: of the angles between the point's normal and theirs, of either sign.
bool is_in_layer(std::span<const double> cosines);

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

}  // namespace surfcast::estimation
