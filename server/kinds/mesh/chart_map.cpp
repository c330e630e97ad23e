#include "mesh/chart_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/hash.h"
#include "mesh/cell_lattice.h"
#include "mesh/placed_triangle.h"
#include "mesh/texture.h"

namespace surfcast::mesh {
namespace {

/// Sets that are joined two by two; the smallest member stands for a set.
class Sets {
 public:
  explicit Sets(size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0U); }

  uint32_t find(uint32_t i) {
    while (parents_[i] != i) {
      parents_[i] = parents_[parents_[i]];
      i = parents_[i];
    }
    return i;
  }
  void join(uint32_t a, uint32_t b) {
    a = find(a);
    b = find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parents_;
};

uint64_t hash_corner(const glm::dvec3& position, const glm::dvec2& uv) {
  const std::array<double, 5> numbers{position.x + 0.0, position.y + 0.0, position.z + 0.0, uv.x + 0.0, uv.y + 0.0};
  return hash_of(std::as_bytes(std::span(numbers)));
}

uint64_t hash_edge(uint64_t a, uint64_t b) {
  const std::array<uint64_t, 2> ends{std::min(a, b), std::max(a, b)};
  return hash_of(std::as_bytes(std::span(ends)));
}

/// How often texture coordinates may cover the image. Further triangles, of textures repeated that often, own no texel.
constexpr double kMaxCovers = 64;

using EdgeOf = std::pair<uint64_t, uint32_t>;  ///< an edge and the number of a triangle beside it

void add_edges(const Patch& patch, const Triangle& triangle, uint32_t number, std::vector<EdgeOf>& edges) {
  std::array<uint64_t, 3> corners{};
  for (size_t k = 0; k < 3; ++k) {
    const uint32_t uv = triangle[k].uv;
    const glm::dvec3 world(patch.to_world * glm::dvec4(patch.vertices->positions[triangle[k].position], 1));
    corners[k] = hash_corner(world, uv == kNone ? glm::dvec2(0) : patch.vertices->uvs[uv]);
  }
  for (size_t k = 0; k < 3; ++k) edges.emplace_back(hash_edge(corners[k], corners[(k + 1) % 3]), number);
}

}  // namespace

std::optional<std::array<glm::dvec2, 3>> texel_corners(const Vertices& vertices, const Triangle& triangle,
                                                       const glm::ivec2& size) {
  constexpr double kMax = 1 << 26;
  std::array<glm::dvec2, 3> corners{};
  for (size_t k = 0; k < 3; ++k) {
    if (triangle[k].uv == kNone) return std::nullopt;
    corners[k] = vertices.uvs[triangle[k].uv] * glm::dvec2(size);
    if (!(std::abs(corners[k].x) < kMax && std::abs(corners[k].y) < kMax)) return std::nullopt;
  }
  return corners;
}

ChartMap::ChartMap(std::span<const Patch* const> patches, const glm::ivec2& size, const std::array<Wrap, 2>& wrap)
    : width_(size.x), owners_(static_cast<size_t>(size.x) * static_cast<size_t>(size.y), kNone) {
  std::vector<EdgeOf> edges;
  uint32_t count = 0;
  for (const Patch* patch : patches) {
    for (const Triangle& triangle : *patch->triangles) add_edges(*patch, triangle, count++, edges);
  }
  std::sort(edges.begin(), edges.end());
  Sets sets(count);
  for (size_t i = 1; i < edges.size(); ++i) {
    if (edges[i].first == edges[i - 1].first) sets.join(edges[i].second, edges[i - 1].second);
  }
  uint32_t number = 0;
  double left = kMaxCovers * static_cast<double>(owners_.size());
  for (const Patch* patch : patches) {
    std::vector<uint32_t>& charts = charts_.emplace_back();
    for (const Triangle& triangle : *patch->triangles) {
      const uint32_t chart = charts.emplace_back(sets.find(number++));
      const auto corners = texel_corners(*patch->vertices, triangle, size);
      if (!corners) continue;
      const CellTriangle cells(*corners);
      if (cells.twice_area() > 2 * left) continue;
      left -= cells.twice_area() / 2;
      cells.for_each_cell(cells.first_row(), cells.end_row(), [&](int64_t i, int64_t j, const glm::dvec3&) {
        const int64_t x = wrapped(i, size.x, wrap[0]);
        const int64_t y = wrapped(j, size.y, wrap[1]);
        uint32_t& owner = owners_[static_cast<size_t>(y * width_ + x)];
        if (owner == kNone) owner = chart;
      });
    }
  }
}

}  // namespace surfcast::mesh
