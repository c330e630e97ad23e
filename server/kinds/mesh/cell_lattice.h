#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace surfcast::mesh {

/// A triangle on a plane of square cells of side 1. Cell (i, j) belongs to the triangle if its centre (i + 1/2, j +
/// 1/2) does. A centre on an edge that two triangles share, with the same corners, belongs to one of them.
class CellTriangle {
 public:
  explicit CellTriangle(const std::array<glm::dvec2, 3>& corners);

  /// Twice the area, positive.
  [[nodiscard]] double twice_area() const { return twice_area_; }
  [[nodiscard]] int64_t first_row() const { return first_row_; }
  [[nodiscard]] int64_t end_row() const { return end_row_; }

  /// Calls `use(i, j, weights)` for every cell of the rows, where weights are barycentric.
  template <typename Use>
  void for_each_cell(int64_t first, int64_t end, Use&& use) const {
    for (int64_t j = std::max(first, first_row_); j < std::min(end, end_row_); ++j) {
      const auto [low, high] = columns(static_cast<double>(j) + 0.5);
      for (auto i = static_cast<int64_t>(std::floor(low)) - 1; static_cast<double>(i) <= high + 1; ++i) {
        glm::dvec3 weights;
        if (contains({static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5}, weights)) use(i, j, weights);
      }
    }
  }

 private:
  /// The side of a line on which points lie. The same number for both directions of an edge, but for its sign.
  struct Edge {
    glm::dvec2 from{0};
    glm::dvec2 along{0};
    double sign = 1;
    bool inclusive = false;

    [[nodiscard]] double at(const glm::dvec2& p) const {
      return sign * (along.x * (p.y - from.y) - along.y * (p.x - from.x));
    }
  };

  static Edge edge_between(const glm::dvec2& a, const glm::dvec2& b, bool turned);
  /// The span of the triangle at that height.
  [[nodiscard]] std::pair<double, double> columns(double y) const;
  [[nodiscard]] bool contains(const glm::dvec2& p, glm::dvec3& weights) const;

  std::array<glm::dvec2, 3> corners_;
  std::array<Edge, 3> edges_;  ///< opposite to each corner
  double twice_area_ = 0;
  int64_t first_row_ = 0;
  int64_t end_row_ = 0;
};

/// How a plane of cells lies in the world: the steps from a cell to the next.
struct CellSteps {
  glm::dvec3 u{0};
  glm::dvec3 v{0};

  /// Of a triangle on cells (`cells`) and in the world.
  static CellSteps of(const std::array<glm::dvec2, 3>& cells, const std::array<glm::dvec3, 3>& world);
  /// The radius of surfels at the centres of the cells: that of square cells of the same area, or what closes the gaps
  /// between oblique ones.
  [[nodiscard]] double radius() const;
};

}  // namespace surfcast::mesh
