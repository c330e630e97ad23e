#include "mesh/cell_lattice.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

namespace surfcast::mesh {
namespace {

using Corners = std::array<glm::dvec2, 3>;

void count_cells(const Corners& corners, std::map<std::pair<int64_t, int64_t>, int>& counts) {
  const CellTriangle triangle(corners);
  triangle.for_each_cell(triangle.first_row(), triangle.end_row(), [&](int64_t i, int64_t j, const glm::dvec3&) {
    ++counts[{i, j}];
  });
}

TEST(CellLattice, EveryCellOfATriangulatedSquareBelongsToOneTriangle) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    // Corners on centres of cells, so that edges run through many of them.
    std::uniform_int_distribution<int> inside(1, 18);
    const glm::dvec2 middle(inside(random) + 0.5, inside(random) + 0.5);
    const std::array<glm::dvec2, 4> square{{{0, 0}, {20, 0}, {20, 20}, {0, 20}}};
    std::map<std::pair<int64_t, int64_t>, int> counts;
    for (size_t k = 0; k < 4; ++k) count_cells({square[k], square[(k + 1) % 4], middle}, counts);
    EXPECT_EQ(counts.size(), 400U);
    for (const auto& [cell, count] : counts) EXPECT_EQ(count, 1) << cell.first << " " << cell.second;
  }
}

TEST(CellLattice, TheDirectionOfRotationDoesNotMatter) {
  std::map<std::pair<int64_t, int64_t>, int> forward;
  std::map<std::pair<int64_t, int64_t>, int> backward;
  count_cells({{{0.2, 0.1}, {7.3, 2.2}, {3.3, 9.1}}}, forward);
  count_cells({{{0.2, 0.1}, {3.3, 9.1}, {7.3, 2.2}}}, backward);
  EXPECT_EQ(forward, backward);
  EXPECT_NEAR(static_cast<double>(forward.size()), 0.5 * (7.1 * 9.0 - 2.1 * 3.1), 4);
}

TEST(CellLattice, WeightsArePlaces) {
  const Corners corners{{{-3, 1}, {6, 2}, {1, 8}}};
  const CellTriangle triangle(corners);
  triangle.for_each_cell(triangle.first_row(), triangle.end_row(), [&](int64_t i, int64_t j, const glm::dvec3& w) {
    const glm::dvec2 place = w.x * corners[0] + w.y * corners[1] + w.z * corners[2];
    EXPECT_NEAR(place.x, static_cast<double>(i) + 0.5, 1e-12);
    EXPECT_NEAR(place.y, static_cast<double>(j) + 0.5, 1e-12);
  });
}

TEST(CellLattice, RowsCanBeTakenInParts) {
  const CellTriangle triangle({{{0, 0}, {30, 5}, {10, 40}}});
  int whole = 0;
  int parts = 0;
  triangle.for_each_cell(triangle.first_row(), triangle.end_row(),
                         [&](int64_t, int64_t, const glm::dvec3&) { ++whole; });
  for (int64_t row = triangle.first_row(); row < triangle.end_row(); row += 7) {
    triangle.for_each_cell(row, row + 7, [&](int64_t, int64_t, const glm::dvec3&) { ++parts; });
  }
  EXPECT_EQ(whole, parts);
}

TEST(CellLattice, ATriangleWithoutAreaHasNoCells) {
  const CellTriangle triangle({{{0, 0}, {10, 10}, {20, 20}}});
  triangle.for_each_cell(triangle.first_row(), triangle.end_row(),
                         [&](int64_t, int64_t, const glm::dvec3&) { FAIL() << "a cell"; });
}

TEST(CellLattice, RadiiAreThoseOfSquaresAndCloseTheGapsOfObliqueCells) {
  const CellSteps square{{2, 0, 0}, {0, 2, 0}};
  EXPECT_NEAR(square.radius(), 1.115 * 2, 1e-12);
  // Cells of the same area, whose centres are as far from some places as 5 is.
  const CellSteps oblique{{8, 0, 0}, {0, 0.5, 0}};
  EXPECT_NEAR(oblique.radius(), 1.3 * std::hypot(4, 0.25), 1e-9);
  // The same lattice by other steps.
  const CellSteps again{{8, 0.5, 0}, {8, 1, 0}};
  EXPECT_NEAR(again.radius(), oblique.radius(), 1e-9);
}

}  // namespace
}  // namespace surfcast::mesh
