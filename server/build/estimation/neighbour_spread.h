#pragma once

#include <cstddef>
#include <glm/vec3.hpp>

#include "estimation/classify_points.h"
#include "estimation/neighbour_offsets.h"

namespace surfcast::estimation {

/// The covariance of a site and some of its neighbours, scaled to a trace of 1.
struct Covariance {
  glm::dvec3 diagonal{0};  ///< xx, yy and zz
  glm::dvec3 mixed{0};     ///< yz, zx and xy
};

/// The covariances of a site with its kNearNeighbours and with all its neighbours, found in one pass.
struct Covariances {
  Covariance near;
  Covariance wide;
};

/// There must be a neighbour.
Covariances covariances_of(const NeighbourOffsets& neighbours);

/// The eigenvalues of the matrix, in closed form.
Spread spread_of(const Covariance& covariance);

/// The direction of least variance (Hoppe et al. 1992, section 3.2): the eigenvector of the smallest eigenvalue, which
/// is `least`. Unit; the sign is arbitrary. Neighbourhoods on a line get a direction perpendicular to it.
glm::dvec3 least_axis(const Covariance& covariance, double least);

/// True if most neighbours lie in the plane through the site, and the plane goes on behind or in front of the others: a
/// sheet beside another one, not a step. `normal`: of the plane of the nearest ones, unit.
bool is_in_sheet(const NeighbourOffsets& neighbours, const glm::dvec3& normal);

/// The kind of a site from the spread of the kNearNeighbours, the covariance of all neighbours and their number. With
/// fewer than kWideNeighbours nothing is known, and the site counts as a surface.
PointKind kind_of_site(const Spread& near, const Covariance& wide, size_t neighbours);

}  // namespace surfcast::estimation
