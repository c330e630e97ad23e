#include "estimation/propagate_signs.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::estimation {
namespace {

/// A wall of 41 by 6 sites with a door, over which one row joins its halves, and a row of sites at its foot whose
/// normals turn from -x over z to x. So the foot agrees with itself, opposes one half of the wall, and agrees with the
/// other.
struct WallWithFoot {
  static constexpr int kColumns = 41;
  static constexpr int kRows = 6;

  std::vector<glm::dvec3> points;
  std::vector<glm::vec3> normals;  ///< of the sites
  std::vector<PointKind> kinds;    ///< likewise
  Sites sites;
  NeighbourGraph graph;

  explicit WallWithFoot(PointKind foot) {
    geometry::Box frame;
    for (int row = 0; row <= kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const bool door = row > 0 && row < kRows && column > 17 && column < 23;
        if (!door) points.emplace_back(0, 0.1 * column, 0.1 * row);
      }
    }
    for (const glm::dvec3& point : points) frame.include(point);
    sites = find_sites(points, frame);
    graph = find_neighbours(sites, 8);
    normals.resize(sites.size());
    kinds.resize(sites.size(), PointKind::kSurface);
    for (size_t i = 0; i < points.size(); ++i) {
      const uint32_t site = sites.of_point[i];
      normals[site] = normal_of(points[i]);
      if (is_foot(points[i])) kinds[site] = foot;
    }
  }

  static bool is_foot(const glm::dvec3& point) { return point.z < 0.05; }

  static glm::vec3 normal_of(const glm::dvec3& point) {
    if (!is_foot(point)) {
      const double tilt = point.y > 1.75 && point.y < 2.25 ? 1.2 : 0;  // over the door
      return {std::cos(tilt), std::sin(tilt), 0};
    }
    const double angle = std::numbers::pi * (1 - point.y / (0.1 * (kColumns - 1)));
    return {std::cos(angle), 0, std::sin(angle)};
  }

  /// The sites of the wall that do not have the sign of most of them.
  [[nodiscard]] size_t sites_inside_out() const {
    const SurfacePieces pieces = propagate_signs(sites, Links(graph, sites.size()), normals, kinds);
    EXPECT_EQ(pieces.count, 1U);
    size_t opposed = 0;
    size_t wall = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      if (is_foot(points[i])) continue;
      ++wall;
      opposed += pieces.opposed[sites.of_point[i]];
    }
    return std::min(opposed, wall - opposed);
  }
};

TEST(PropagateSigns, ScatterAtTheFootOfAWallTurnsNoPartOfIt) {
  EXPECT_EQ(WallWithFoot(PointKind::kScatter).sites_inside_out(), 0U);
  EXPECT_EQ(WallWithFoot(PointKind::kThread).sites_inside_out(), 0U);
}

/// The foot of this test would turn a part of the wall if it had a whole vote.
TEST(PropagateSigns, ASurfaceThatTurnsHasItsVote) {
  EXPECT_GT(WallWithFoot(PointKind::kSurface).sites_inside_out(), 0U);
}

TEST(PropagateSigns, KindsMayBeUnknown) {
  const WallWithFoot wall(PointKind::kSurface);
  const Links links(wall.graph, wall.sites.size());
  const SurfacePieces with = propagate_signs(wall.sites, links, wall.normals, wall.kinds);
  const SurfacePieces without = propagate_signs(wall.sites, links, wall.normals, {});
  EXPECT_EQ(with.opposed, without.opposed);
}

}  // namespace
}  // namespace surfcast::estimation
