#include "mesh/mesh_edges.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include <oneapi/tbb/parallel_sort.h>

#include "base/hash.h"
#include "mesh/placed_triangle.h"

namespace surfcast::mesh {
namespace {

/// Corners closer than this share of the diagonal are at one place: instances compute the same place in different ways.
constexpr double kSamePlace = 1e-7;

constexpr uint64_t kForward = 1;  ///< the lowest bit of a key: the direction of the edge

template <typename T>
uint64_t hash_value(const T& value) {
  return hash_of(std::as_bytes(std::span(&value, 1)));
}

}  // namespace

/// A hash of both ends, with the direction in its lowest bit.
uint64_t MeshEdges::key(const glm::dvec3& from, const glm::dvec3& to) const {
  const auto place = [this](const glm::dvec3& p) { return hash_value(glm::round((p - origin_) / step_) + 0.0); };
  const uint64_t a = place(from);
  const uint64_t b = place(to);
  const std::array<uint64_t, 2> ends{std::min(a, b), std::max(a, b)};
  return (hash_value(ends) & ~kForward) | (a < b ? kForward : 0);
}

MeshEdges::MeshEdges(const Mesh& mesh, const geometry::Box& bounds) : origin_(bounds.centre()) {
  step_ = std::max(bounds.diagonal() * kSamePlace, 1e-300);
  std::vector<uint64_t> keys;
  keys.reserve(3 * mesh.triangles());
  for (const Patch& patch : mesh.patches) {
    for (const Triangle& triangle : *patch.triangles) {
      const std::array<glm::dvec3, 3> p = placed_positions(patch, triangle);
      for (size_t k = 0; k < 3; ++k) keys.push_back(key(p[k], p[(k + 1) % 3]));
      volume_ += glm::dot(p[0] - origin_, glm::cross(p[1] - origin_, p[2] - origin_));
    }
  }
  oneapi::tbb::parallel_sort(keys.begin(), keys.end());
  closed_ = true;
  for (size_t first = 0; first < keys.size();) {
    size_t end = first;
    int64_t balance = 0;
    for (; end < keys.size() && (keys[end] | kForward) == (keys[first] | kForward); ++end) {
      balance += (keys[end] & kForward) != 0 ? 1 : -1;
    }
    closed_ = closed_ && balance == 0;
    if (end - first == 1) open_.push_back(keys[first] | kForward);
    first = end;
  }
}

std::array<bool, 3> MeshEdges::open(const std::array<glm::dvec3, 3>& positions) const {
  std::array<bool, 3> open{};
  for (size_t k = 0; k < 3 && !open_.empty(); ++k) {
    const uint64_t edge = key(positions[k], positions[(k + 1) % 3]) | kForward;
    open[k] = std::binary_search(open_.begin(), open_.end(), edge);
  }
  return open;
}

}  // namespace surfcast::mesh
