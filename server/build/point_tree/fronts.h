#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "estimation/neighbours.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::point_tree {

/// The normals of the points of a cell, as far as their fronts are known.
struct Fronts {
  std::vector<uint64_t> codes;     ///< of the points (CellSurfels::codes), ascending
  std::vector<glm::vec3> normals;  ///< out of the surface, unit; zero where the front is not known

  [[nodiscard]] size_t bytes() const {
    return sizeof(*this) + codes.size() * sizeof(codes[0]) + normals.size() * sizeof(normals[0]);
  }
};

/// Turns the normals of a cell outwards, as an upper level knows them.
///
/// A build propagates signs through the whole scan. A cell alone seldom tells outside from inside: a wall may be all
/// that it has. But the points of an upper level are points of this level as well, and the root is a small scan of the
/// whole, whose signs are resolved as in a build. From those points, signs spread to their neighbours by the votes of
/// links (estimation/sign_vote.h). Scatter has no front, and does not vote.
///
/// `above`: of the upper level. `codes`: of the first surfels, those of the cell; the others are its halo.
/// `neighbourhoods`: of all of them. The cloud counts as oriented if the fronts of nearly all discs of the cell are
/// found. Returns the fronts of the cell.
Fronts turn_outwards(const estimation::Neighbourhoods& neighbourhoods, std::span<const uint64_t> codes,
                     const Fronts& above, surfel::SurfelCloud& cloud);

/// The fronts of a cell whose cloud is oriented.
Fronts fronts_of(std::span<const uint64_t> codes, const surfel::SurfelCloud& cloud);

}  // namespace surfcast::point_tree
