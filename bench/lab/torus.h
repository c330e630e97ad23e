#pragma once

#include <cstdint>
#include <vector>

#include "reference/ray_surface.h"

namespace surfcast::lab {

/// The torus about z with a tube of radius `tube` whose centre line is at distance `ring` from the axis. u is the angle
/// about z, v the angle about the tube.
struct Torus {
  double ring = 0.7;
  double tube = 0.3;
};

reference::SurfacePoint torus_point(const Torus& torus, double u, double v);
reference::RaySurface ray_surface(const Torus& torus);
/// A lattice of `around` x `along` samples in angles, each moved by up to half a cell. On the inner side the samples
/// are as dense as those of a rotating scanner inside the torus; on the outer side they are several times sparser and
/// stretched.
std::vector<reference::SurfacePoint> uneven_samples(const Torus& torus, int around, int along, uint32_t seed);

}  // namespace surfcast::lab
