#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>

#include "estimation/nearest_list.h"
#include "geometry/morton_tree.h"

namespace surfcast::estimation {

/// The `degree` points of a tree that are nearest to a place. Points for which `skip(i)` is true are left out.
/// `points` are those of the tree.
template <size_t Largest, typename Skip>
NearestList<Largest> nearest_in_tree(const geometry::MortonTree& tree, std::span<const glm::dvec3> points,
                                     const glm::dvec3& from, size_t degree, const Skip& skip) {
  NearestList<Largest> nearest(degree);
  double bound = nearest.bound();
  tree.nearest_first(from, bound, [&](const geometry::MortonTree::Run& run) {
    for (uint32_t i = run.first; i < run.last; ++i) {
      if (!skip(i)) nearest.add({squared_distance(points[i], from), i});
    }
    bound = nearest.bound();
  });
  return nearest;
}

}  // namespace surfcast::estimation
