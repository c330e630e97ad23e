#include "warp/warp_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace surfcast::warp {
namespace {

constexpr int kMeshedWidth = 123;
constexpr int kMeshedHeight = 70;
constexpr int kMeshedCell = 8;

/// The plane of a frame whose pixels have these inverse depths.
DepthPlane plane_of(const std::function<float(double x, double y)>& inverse) {
  DepthPlane plane{
      (kMeshedWidth + kMeshedCell - 1) / kMeshedCell, (kMeshedHeight + kMeshedCell - 1) / kMeshedCell, kMeshedCell, {}};
  plane.inverse.assign(static_cast<size_t>(plane.width) * static_cast<size_t>(plane.height), 0);
  for (int y = 0; y < kMeshedHeight; ++y) {
    for (int x = 0; x < kMeshedWidth; ++x) {
      float& texel = plane.inverse[static_cast<size_t>(y / kMeshedCell * plane.width + x / kMeshedCell)];
      texel = std::max(texel, inverse(x + 0.5, y + 0.5));
    }
  }
  return plane;
}

size_t count(const WarpMesh& mesh, Sheet sheet) {
  return static_cast<size_t>(std::ranges::count(mesh, sheet, &MeshTriangle::sheet));
}

double area(const MeshTriangle& triangle) {
  const glm::vec2 a = triangle.corners[0].pixel;
  const glm::vec2 b = triangle.corners[1].pixel;
  const glm::vec2 c = triangle.corners[2].pixel;
  return 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

bool in_frame(const MeshTriangle& triangle) {
  return std::ranges::all_of(triangle.corners, [](const MeshVertex& v) {
    return v.pixel.x >= 0 && v.pixel.y >= 0 && v.pixel.x <= kMeshedWidth && v.pixel.y <= kMeshedHeight;
  });
}

/// Of a texel.
glm::vec2 centre_of(size_t texel) {
  const size_t columns = (kMeshedWidth + kMeshedCell - 1) / kMeshedCell;
  return (glm::vec2(texel % columns, texel / columns) + 0.5F) * float{kMeshedCell};
}

float step(double x, double) {
  return x < 40 ? 1.0F : 0.1F;
}

TEST(WarpMesh, CoversTheFrameOnceWithEachSheet) {
  const WarpMesh mesh = make_warp_mesh(plane_of(step), kMeshedWidth, kMeshedHeight);
  double surface = 0;
  double near = 0;
  double far = 0;
  for (const MeshTriangle& triangle : mesh) {
    if (triangle.sheet == Sheet::kSurface) surface += area(triangle);
    if (triangle.sheet == Sheet::kNear) near += area(triangle);
    if (triangle.sheet == Sheet::kFar) far += area(triangle);
  }
  EXPECT_GT(near, 0);
  EXPECT_NEAR(near, far, 1e-3);
  EXPECT_NEAR(surface + near, kMeshedWidth * kMeshedHeight, 1e-3);
}

TEST(WarpMesh, GoesOnBeyondTheBorders) {
  const WarpMesh mesh = make_warp_mesh(plane_of([](double, double) { return 1.0F; }), kMeshedWidth, kMeshedHeight);
  EXPECT_EQ(count(mesh, Sheet::kNear), 0U);
  for (const MeshTriangle& triangle : mesh) EXPECT_EQ(triangle.sheet == Sheet::kSurroundings, !in_frame(triangle));
}

TEST(WarpMesh, OfASlantedPlaneIsWholeAndLiesInIt) {
  // From 0.2 to 4.9 across the frame: a plane that is seen at a grazing angle.
  const auto inverse = [](double x, double y) { return static_cast<float>(0.2 + 0.03 * x + 0.015 * y); };
  const WarpMesh mesh = make_warp_mesh(plane_of(inverse), kMeshedWidth, kMeshedHeight);
  EXPECT_EQ(count(mesh, Sheet::kNear), 0U);
  for (const MeshTriangle& triangle : mesh) {
    for (const MeshVertex& vertex : triangle.corners) {
      // (The cells at the right and at the lower border are narrower.)
      const bool border = vertex.pixel.x < 8 || vertex.pixel.y < 8 || vertex.pixel.x > 108 || vertex.pixel.y > 56;
      if (triangle.sheet == Sheet::kSurroundings || border) continue;
      // The nearest pixel of a cell has its centre half a pixel before the corner of the cell.
      EXPECT_NEAR(vertex.inverse, inverse(vertex.pixel.x, vertex.pixel.y), 0.025) << vertex.pixel.x;
    }
  }
}

TEST(WarpMesh, IsTwoSheetsAroundASquareBeforeAPlane) {
  const auto square = [](double x, double y) { return x > 40 && x < 80 && y > 24 && y < 48; };
  const WarpMesh mesh = make_warp_mesh(plane_of([&](double x, double y) { return square(x, y) ? 1.0F : 0.2F; }),
                                       kMeshedWidth, kMeshedHeight);
  EXPECT_GT(count(mesh, Sheet::kNear), 0U);
  for (const MeshTriangle& triangle : mesh) {
    if (triangle.sheet == Sheet::kSurface || !in_frame(triangle)) continue;
    EXPECT_FALSE(square(triangle.far.x, triangle.far.y));
    for (const MeshVertex& vertex : triangle.corners) {
      if (triangle.sheet != Sheet::kNear) {
        const glm::vec2 centre = centre_of(vertex.fill_texel);
        EXPECT_FALSE(square(centre.x, centre.y)) << "what is behind goes on";
      }
      if (triangle.sheet == Sheet::kFill) continue;
      EXPECT_EQ(vertex.inverse, triangle.sheet == Sheet::kNear ? 1.0F : 0.2F);
      EXPECT_EQ(vertex.front == 1, square(vertex.pixel.x, vertex.pixel.y));
    }
  }
}

TEST(WarpMesh, BackgroundIsInfinitelyFarAndAnOutlineBesideEverySurface) {
  const WarpMesh mesh =
      make_warp_mesh(plane_of([](double x, double) { return x < 64 ? 1e-6F : 0.0F; }), kMeshedWidth, kMeshedHeight);
  EXPECT_GT(count(mesh, Sheet::kNear), 0U);
  EXPECT_GT(std::ranges::count_if(mesh, &MeshTriangle::background), 0);
  for (const MeshTriangle& triangle : mesh) {
    if (triangle.sheet != Sheet::kSurface) continue;
    for (const MeshVertex& vertex : triangle.corners) EXPECT_EQ(vertex.inverse == 0, triangle.background);
  }
}

TEST(WarpMesh, BehindASurfaceNoTriangleJoinsAnotherOneAndBackground) {
  const auto square = [](double x, double y) { return x > 40 && x < 80 && y > 24 && y < 48; };
  const WarpMesh mesh =
      make_warp_mesh(plane_of([&](double x, double y) { return square(x, y) ? 1.0F : (x + y < 100 ? 0.2F : 0.0F); }),
                     kMeshedWidth, kMeshedHeight);
  std::array<int, 2> triangles{};
  for (const MeshTriangle& triangle : mesh) {
    if (triangle.sheet != Sheet::kFar) continue;
    const auto open = std::ranges::count(triangle.corners, 0.0F, &MeshVertex::inverse);
    EXPECT_TRUE(open == 0 || open == 3) << triangle.corners[0].pixel.x << " " << triangle.corners[0].pixel.y;
    ++triangles.at(open == 0 ? 0 : 1);
  }
  EXPECT_GT(triangles[0], 10);
  EXPECT_GT(triangles[1], 10);
}

TEST(WarpMesh, OfAFrameOfOneCellIsASheet) {
  const WarpMesh mesh = make_warp_mesh({1, 1, 200, {0.5F}}, 200, 100);
  EXPECT_EQ(count(mesh, Sheet::kNear), 0U);
  for (const MeshTriangle& triangle : mesh) {
    for (const MeshVertex& vertex : triangle.corners) EXPECT_EQ(vertex.inverse, 0.5F);
  }
}

}  // namespace
}  // namespace surfcast::warp
