#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/box.h"
#include "mesh/mesh.h"

namespace surfcast::mesh {

/// Which edges of a mesh have a surface on one side only. Corners at the same place are the same, whatever their other
/// values are and whichever patch they belong to.
class MeshEdges {
 public:
  MeshEdges(const Mesh& mesh, const geometry::Box& bounds);

  /// Of the edges from corner k to the next one.
  [[nodiscard]] std::array<bool, 3> open(const std::array<glm::dvec3, 3>& positions) const;
  /// True if every edge joins two triangles (or four ...) that run along it in opposite directions: a solid.
  [[nodiscard]] bool closed() const { return closed_; }
  /// True if the solid's triangles run clockwise as seen from outside.
  [[nodiscard]] bool inside_out() const { return closed_ && volume_ < 0; }

 private:
  [[nodiscard]] uint64_t key(const glm::dvec3& from, const glm::dvec3& to) const;

  glm::dvec3 origin_{0};
  double step_ = 1;
  bool closed_ = false;
  double volume_ = 0;
  std::vector<uint64_t> open_;  ///< keys, sorted
};

}  // namespace surfcast::mesh
