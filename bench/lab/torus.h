#pragma once

#include <cstdint>
#include <vector>

#include "reference/ray_surface.h"

namespace surfcast::lab {

/// The torus about z whose tube of radius `tube` runs at `ring` from the axis; u is the angle about z, v about the
/// tube.
struct Torus {
  double ring = 0.7;
  double tube = 0.3;
};

reference::SurfacePoint torus_point(const Torus& torus, double u, double v);
reference::RaySurface ray_surface(const Torus& torus);
/// A lattice of `around` x `along` samples in angles, every one moved by up to half a cell: as dense on the inner side
/// as a scanner that turns within it makes them, several times as sparse and stretched on the outer side.
std::vector<reference::SurfacePoint> uneven_samples(const Torus& torus, int around, int along, uint32_t seed);

}  // namespace surfcast::lab
