#include "mesh/mesh.h"

#include <algorithm>
#include <numeric>

namespace surfcast::mesh {

uint64_t Mesh::triangles() const {
  return std::accumulate(patches.begin(), patches.end(), uint64_t{0},
                         [](uint64_t sum, const Patch& patch) { return sum + patch.triangles->size(); });
}

bool Mesh::colored() const {
  return std::any_of(patches.begin(), patches.end(), [this](const Patch& patch) {
    const Material& material = materials[patch.material];
    return !patch.vertices->colors.empty() || material.image || material.color != glm::vec4(1);
  });
}

geometry::Box Mesh::bounds() const {
  geometry::Box box;
  for (const Patch& patch : patches) {
    for (const Triangle& triangle : *patch.triangles) {
      for (const Corner& corner : triangle) {
        box.include(glm::dvec3(patch.to_world * glm::dvec4(patch.vertices->positions[corner.position], 1)));
      }
    }
  }
  return box;
}

}  // namespace surfcast::mesh
