#include "mesh/placed_triangle.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace surfcast::mesh {
namespace {

bool mirrored(const Patch& patch) {
  return glm::determinant(glm::dmat3(patch.to_world)) < 0;
}

/// In the order in which they run in the world.
Triangle corners_of(const Patch& patch, Triangle triangle) {
  if (mirrored(patch)) std::swap(triangle[1], triangle[2]);
  return triangle;
}

/// The normal of the file if it has a direction, on the side of the face.
glm::dvec3 normal_at(const Corner& corner, const Patch& patch, const glm::dmat3& to_world, const glm::dvec3& face) {
  if (corner.normal == kNone) return face;
  const glm::dvec3 stated = to_world * glm::dvec3(patch.vertices->normals[corner.normal]);
  const double length = glm::length(stated);
  if (!(length > 0 && std::isfinite(length))) return face;
  return glm::dot(stated, face) < 0 ? -stated / length : stated / length;
}

}  // namespace

std::array<glm::dvec3, 3> placed_positions(const Patch& patch, const Triangle& triangle) {
  std::array<glm::dvec3, 3> positions{};
  const Triangle corners = corners_of(patch, triangle);
  for (size_t k = 0; k < 3; ++k) {
    positions[k] = glm::dvec3(patch.to_world * glm::dvec4(patch.vertices->positions[corners[k].position], 1));
  }
  return positions;
}

PlacedTriangle place(const Patch& patch, const Triangle& triangle, bool flip) {
  PlacedTriangle placed;
  const Triangle corners = corners_of(patch, triangle);
  placed.positions = placed_positions(patch, triangle);
  placed.face = glm::cross(placed.positions[1] - placed.positions[0], placed.positions[2] - placed.positions[0]);
  const double length = glm::length(placed.face);
  const glm::dvec3 face = length > 0 ? placed.face / length : glm::dvec3(0, 0, 1);
  const glm::dmat3 normals_to_world = glm::transpose(glm::inverse(glm::dmat3(patch.to_world)));
  const Vertices& vertices = *patch.vertices;
  for (size_t k = 0; k < 3; ++k) {
    placed.normals[k] = (flip ? -1.0 : 1.0) * normal_at(corners[k], patch, normals_to_world, face);
  }
  if (std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.uv != kNone; })) {
    placed.uvs = {vertices.uvs[corners[0].uv], vertices.uvs[corners[1].uv], vertices.uvs[corners[2].uv]};
  }
  if (!vertices.colors.empty()) {
    placed.colors = {vertices.colors[corners[0].position], vertices.colors[corners[1].position],
                     vertices.colors[corners[2].position]};
  }
  return placed;
}

}  // namespace surfcast::mesh
