#include "warp/warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

namespace surfcast::warp {
namespace {

constexpr int kFrameWidth = 320;
constexpr int kFrameHeight = 200;
constexpr int kFrameCell = 8;
using Color = std::array<uint8_t, 3>;
constexpr std::array<uint8_t, 4> kBackground{10, 20, 30, 255};
constexpr Color kBackgroundColor{10, 20, 30};

geometry::CameraFrame camera(const glm::dvec3& eye, const glm::dvec3& at, int width = kFrameWidth,
                             int height = kFrameHeight) {
  return *geometry::make_camera_frame({eye, at, {0, 1, 0}, 40}, width, height);
}

/// What a ray through a pixel meets: the distance along the view axis and the colour.
struct Hit {
  double depth = 0;  ///< 0: nothing
  Color color = kBackgroundColor;
};
/// `ray`: in world coordinates, with a depth of 1.
using Scene = std::function<Hit(const glm::dvec3& eye, const glm::dvec3& ray)>;

Hit hit_at(const Scene& scene, const geometry::CameraFrame& camera, const glm::dvec2& pixel) {
  const glm::dvec3 ray = camera.ray(pixel);
  return scene(camera.eye, camera.right * ray.x + camera.up * ray.y + camera.forward * ray.z);
}

WarpFrame draw(const Scene& scene, const geometry::CameraFrame& from, int cell = kFrameCell) {
  Pixels pixels{from.width, from.height, {}};
  DepthPlane depth{(from.width + cell - 1) / cell, (from.height + cell - 1) / cell, cell, {}};
  depth.inverse.assign(static_cast<size_t>(depth.width) * static_cast<size_t>(depth.height), 0);
  for (int y = 0; y < from.height; ++y) {
    for (int x = 0; x < from.width; ++x) {
      const Hit hit = hit_at(scene, from, {x + 0.5, y + 0.5});
      pixels.bytes.insert(pixels.bytes.end(), hit.color.begin(), hit.color.end());
      pixels.bytes.push_back(255);
      float& texel = depth.inverse[static_cast<size_t>(y / cell * depth.width + x / cell)];
      if (hit.depth > 0) texel = std::max(texel, static_cast<float>(1 / hit.depth));
    }
  }
  return make_warp_frame(std::move(pixels), from, depth);
}

/// Coordinates as colours, which bilinear interpolation keeps.
Color ramp(double u, double v) {
  const auto code = [](double value) { return static_cast<uint8_t>(std::clamp(value * 255, 0.0, 255.0)); };
  return {code(u), code(v), 128};
}

/// The plane z = 0, seen from z > 0.
Hit wall(const glm::dvec3& eye, const glm::dvec3& ray) {
  if (ray.z >= 0) return {};
  const double depth = -eye.z / ray.z;
  const glm::dvec3 at = eye + depth * ray;
  return {depth, ramp(at.x / 8 + 0.5, at.y / 8 + 0.5)};
}

/// A red square at z = 1 in front of the wall.
Hit square(const glm::dvec3& eye, const glm::dvec3& ray) {
  const double depth = (1 - eye.z) / ray.z;
  const glm::dvec3 at = eye + depth * ray;
  if (depth > 0 && std::abs(at.x) < 0.5 && std::abs(at.y) < 0.5) return {depth, {255, 0, 0}};
  return wall(eye, ray);
}

Color pixel_of(const Pixels& picture, int x, int y) {
  const auto at = 4 * (static_cast<size_t>(y) * static_cast<size_t>(picture.width) + static_cast<size_t>(x));
  return {picture.bytes[at], picture.bytes[at + 1], picture.bytes[at + 2]};
}

int difference(const Color& a, const Color& b) {
  int largest = 0;
  for (size_t i = 0; i < 3; ++i) largest = std::max(largest, std::abs(int{a.at(i)} - int{b.at(i)}));
  return largest;
}

TEST(Warp, ToTheSameCameraIsTheFrame) {
  const WarpFrame frame = draw(square, camera({0.3, 0.2, 4}, {0, 0, 0}));
  for (const WarpFrame* rest : {static_cast<const WarpFrame*>(nullptr), &frame}) {
    const Pixels warped = warp(frame, rest, frame.camera, kBackground);
    for (int y = 0; y < kFrameHeight; ++y) {
      for (int x = 0; x < kFrameWidth; ++x) {
        EXPECT_EQ(pixel_of(warped, x, y), pixel_of(frame.pixels, x, y)) << x << " " << y;
      }
    }
  }
}

TEST(Warp, ByARotationIsAHomographyWhateverTheDepth) {
  const geometry::CameraFrame from = camera({0, 0, 4}, {0, 0, 0});
  const geometry::CameraFrame to = camera({0, 0, 4}, {0.6, 0.3, 0});
  WarpFrame frame = draw(wall, from);
  for (MeshTriangle& triangle : frame.mesh) {
    for (MeshVertex& vertex : triangle.corners) vertex.inverse *= 1 + 0.2F * std::sin(vertex.pixel.x);
  }
  const Pixels warped = warp(frame, nullptr, to, kBackground);
  int compared = 0;
  for (int y = 0; y < kFrameHeight; ++y) {
    for (int x = 0; x < kFrameWidth; ++x) {
      const glm::dvec2 pixel(x + 0.5, y + 0.5);
      const glm::dvec3 ray = to.ray(pixel);
      const glm::dvec2 source = from.project(from.rotate(to.right * ray.x + to.up * ray.y + to.forward * ray.z));
      if (source.x < 1 || source.y < 1 || source.x > kFrameWidth - 1 || source.y > kFrameHeight - 1) continue;
      ++compared;
      EXPECT_LE(difference(pixel_of(warped, x, y), hit_at(wall, to, pixel).color), 1);
    }
  }
  EXPECT_GT(compared, kFrameWidth * kFrameHeight / 2);
}

TEST(Warp, OfASlantedPlaneIsThePlaneAsTheTargetSeesIt) {
  const geometry::CameraFrame from = camera({0, -2, 1.5}, {0, 0, 0});  // 53 degrees from its normal
  const geometry::CameraFrame to = camera({0.4, -1.9, 1.4}, {0, 0.1, 0});
  const Pixels warped = warp(draw(wall, from, 4), nullptr, to, kBackground);
  int compared = 0;
  for (int y = 0; y < kFrameHeight; ++y) {
    for (int x = 0; x < kFrameWidth; ++x) {
      const glm::dvec2 pixel(x + 0.5, y + 0.5);
      const Hit hit = hit_at(wall, to, pixel);
      const glm::dvec3 ray = to.ray(pixel);
      const glm::dvec3 world = to.eye + hit.depth * (to.right * ray.x + to.up * ray.y + to.forward * ray.z);
      const glm::dvec2 source = from.project(from.to_camera(world));
      if (source.x < 8 || source.y < 8 || source.x > kFrameWidth - 8 || source.y > kFrameHeight - 8) continue;
      ++compared;
      // A pixel is 0.006 to 0.02 units of the plane: 0.2 to 0.7 levels.
      EXPECT_LE(difference(pixel_of(warped, x, y), hit.color), 1) << x << " " << y;
    }
  }
  EXPECT_GT(compared, kFrameWidth * kFrameHeight / 2);
}

TEST(Warp, ANearSquareKeepsItsOutline) {
  const geometry::CameraFrame from = camera({0, 0, 4}, {0, 0, 0});
  const WarpFrame frame = draw(square, from);
  for (const double step : {0.1, 0.3, 0.8}) {
    const geometry::CameraFrame to = camera({step, step / 2, 4}, {step, step / 2, 0});
    const Pixels warped = warp(frame, nullptr, to, kBackground);
    int red = 0;
    for (int y = 0; y < kFrameHeight; ++y) {
      for (int x = 0; x < kFrameWidth; ++x) {
        if (difference(pixel_of(warped, x, y), {255, 0, 0}) > 100) continue;
        ++red;
        bool near = false;  // within a pixel of the square
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            near |= hit_at(square, to, {x + 0.5 + dx, y + 0.5 + dy}).color == Color{255, 0, 0};
          }
        }
        EXPECT_TRUE(near) << x << " " << y << ", moved by " << step;
      }
    }
    const double side = from.eta / 3;  // pixels
    EXPECT_NEAR(red, side * side, 4 * side);
  }
}

TEST(Warp, WhatComesOutBehindANearSquareHasTheColorOfTheWall) {
  const WarpFrame frame = draw(square, camera({0, 0, 4}, {0, 0, 0}));
  const geometry::CameraFrame to = camera({0.5, 0, 4}, {0.5, 0, 0});
  const Pixels warped = warp(frame, nullptr, to, kBackground);
  for (int y = 40; y < kFrameHeight - 40; ++y) {
    for (int x = 40; x < kFrameWidth - 80; ++x) {
      const Color truth = hit_at(square, to, {x + 0.5, y + 0.5}).color;
      const Color shown = pixel_of(warped, x, y);
      if (truth == Color{255, 0, 0} || difference(shown, {255, 0, 0}) < 150) continue;
      EXPECT_LE(difference(shown, truth), 60) << x << " " << y;
    }
  }
}

TEST(Warp, WhatOpensHasTheMeanColorOfWhatIsBehind) {
  // A wall of lines, one pixel each; the mean of any texels is 150.
  const geometry::CameraFrame from = camera({0, 0, 4}, {0, 0, 0});
  const auto lines = [&](const glm::dvec3& eye, const glm::dvec3& ray) {
    Hit hit = square(eye, ray);
    if (hit.color == Color{255, 0, 0}) return hit;
    const auto row = static_cast<int>(from.project(from.to_camera(eye + hit.depth * ray)).y + 1000);
    hit.color = row % 2 == 0 ? Color{0, 100, 0} : Color{0, 200, 0};
    return hit;
  };
  const WarpFrame frame = draw(lines, from);
  const geometry::CameraFrame to = camera({0.9, 0, 4}, {0.9, 0, 0});  // the square by 82 pixels, the wall by 62
  const Pixels warped = warp(frame, nullptr, to, kBackground);
  int opened = 0;
  for (int y = 70; y < 130; ++y) {
    for (int x = 0; x < kFrameWidth; ++x) {
      const glm::dvec2 pixel(x + 0.5, y + 0.5);
      const Hit hit = hit_at(square, to, pixel);
      // (Within a cell of the outline, pixels of the wall may be taken for the square.)
      if (hit_at(square, to, {x + 0.5 - kFrameCell, y + 0.5}).color == Color{255, 0, 0}) continue;
      const glm::dvec3 ray = to.ray(pixel);
      const glm::dvec3 world = to.eye + hit.depth * (to.right * ray.x + to.up * ray.y + to.forward * ray.z);
      const double source = from.project(from.to_camera(world)).x;
      if (std::abs(source - kFrameWidth / 2.0) > from.eta / 6 - 10) continue;  // seen by the frame, or nearly
      ++opened;
      EXPECT_LE(difference(pixel_of(warped, x, y), {0, 150, 0}), 1) << x << " " << y;
    }
  }
  EXPECT_GT(opened, 100);
}

TEST(Warp, BeyondTheBorderAReflectionFadesToTheMeanColorThere) {
  const geometry::CameraFrame from = camera({0, 0, 4}, {0, 0, 0});
  const geometry::CameraFrame to = camera({0, 0, 4}, {0.4, 0, 0});  // a turn to the right
  const auto stripes = [](const glm::dvec3& eye, const glm::dvec3& ray) {
    Hit hit = wall(eye, ray);
    const bool light = std::fmod((eye + hit.depth * ray).x + 100, 0.2) < 0.1;  // 7 pixels each
    hit.color = light ? Color{200, 200, 200} : Color{100, 100, 100};
    return hit;
  };
  const WarpFrame frame = draw(stripes, from);
  const Pixels warped = warp(frame, nullptr, to, kBackground);
  int columns = 0;
  for (int x = 0; x < kFrameWidth; ++x) {
    const glm::dvec3 ray = to.ray({x + 0.5, kFrameHeight / 2.0});
    const double source = from.project(from.rotate(to.right * ray.x + to.up * ray.y + to.forward * ray.z)).x;
    if (source <= kFrameWidth) continue;
    const auto reflected = static_cast<int>(2 * kFrameWidth - source);
    const auto in_frame = [&](int column) { return int{pixel_of(frame.pixels, column, kFrameHeight / 2)[0]}; };
    if (in_frame(reflected - 1) != in_frame(reflected + 1)) continue;  // between two stripes
    const double share = std::pow(1 - std::min((source - kFrameWidth) / (kFrameHeight / 4.0), 1.0), 2);
    EXPECT_NEAR(pixel_of(warped, x, kFrameHeight / 2)[0], share * in_frame(reflected) + (1 - share) * 150, 12) << x;
    ++columns;
  }
  EXPECT_GT(columns, 20);
}

TEST(Warp, ASharperFrameAtRestIsShownWhereItAgrees) {
  const geometry::CameraFrame to = camera({0.1, 0, 4}, {0.1, 0, 0});
  const WarpFrame rest = draw(wall, camera({0, 0, 4}, {0, 0, 0}));
  WarpFrame newest = draw(wall, camera({0.1, 0, 4}, {0.1, 0, 0}, kFrameWidth / 2, kFrameHeight / 2), kFrameCell / 2);
  std::ranges::fill(newest.pixels.bytes, uint8_t{0});
  const Pixels both = warp(newest, &rest, to, kBackground);
  const Pixels alone = warp(rest, nullptr, to, kBackground);
  // (Beyond the border of the frame at rest the newest one is shown.)
  for (int x = 0; x < kFrameWidth - 16; ++x) EXPECT_EQ(pixel_of(both, x, 100), pixel_of(alone, x, 100));
  EXPECT_EQ(pixel_of(both, kFrameWidth - 1, 100), (Color{0, 0, 0}));
}

TEST(Warp, WhereThingsAreSeenThroughAFrameAtRestIsShownWhereItLooksTheSame) {
  const geometry::CameraFrame to = camera({0, 0, 4}, {0, 0, 0});
  WarpFrame rest = draw(wall, to);
  WarpFrame newest = draw(wall, camera({0, 0, 4}, {0, 0, 0}, kFrameWidth / 2, kFrameHeight / 2), kFrameCell / 2);
  std::ranges::fill(rest.pixels.bytes, uint8_t{100});
  const Color of_rest{100, 100, 100};
  for (const int off : {20, 60}) {
    const auto other = static_cast<uint8_t>(100 + off);
    std::ranges::fill(newest.pixels.bytes, other);
    for (const bool seen_through : {false, true}) {
      rest.seen_through = seen_through;
      const Color expected = seen_through && off > 45 ? Color{other, other, other} : of_rest;
      EXPECT_EQ(pixel_of(warp(newest, &rest, to, kBackground), 50, 50), expected) << off << seen_through;
    }
  }
}

TEST(Warp, AFrameAtRestIsNotShownWhereTheNewestSeesSomethingElse) {
  const geometry::CameraFrame to = camera({0, 0, 4}, {0, 0, 0});
  const WarpFrame rest = draw(square, to);
  const WarpFrame newest = draw(wall, camera({0, 0, 4}, {0, 0, 0}, kFrameWidth / 2, kFrameHeight / 2), kFrameCell / 2);
  EXPECT_NE(pixel_of(warp(newest, &rest, to, kBackground), kFrameWidth / 2, kFrameHeight / 2), (Color{255, 0, 0}));
}

TEST(Warp, AFrameAtRestIsNotShownWhereItIsBlurredByStretching) {
  // The eye has come four times as near since.
  const WarpFrame rest = draw(wall, camera({0, 0, 4}, {0, 0, 0}));
  const geometry::CameraFrame to = camera({0, 0, 1}, {0, 0, 0});
  WarpFrame newest = draw(wall, camera({0, 0, 1}, {0, 0, 0}, kFrameWidth / 2, kFrameHeight / 2), kFrameCell / 2);
  std::ranges::fill(newest.pixels.bytes, uint8_t{0});
  EXPECT_EQ(pixel_of(warp(newest, &rest, to, kBackground), kFrameWidth / 2, kFrameHeight / 2), (Color{0, 0, 0}));
}

TEST(Warp, AFrameAtRestIsNotShownWhereTheEyeHasGoneFarAround) {
  for (const double degrees : {20.0, 30.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const geometry::CameraFrame to = camera({4 * std::sin(angle), 0, 4 * std::cos(angle)}, {0, 0, 0});
    WarpFrame rest = draw(wall, camera({0, 0, 4}, {0, 0, 0}));
    std::ranges::fill(rest.pixels.bytes, uint8_t{255});
    const bool shown = pixel_of(warp(draw(wall, to), &rest, to, kBackground), kFrameWidth / 2, kFrameHeight / 2) ==
                       Color{255, 255, 255};
    EXPECT_EQ(shown, degrees < 25);
  }
}

TEST(Warp, WhereNothingWasSeenIsBackground) {
  const WarpFrame frame = draw(wall, camera({0, 0, 4}, {0, 0, 0}));
  const geometry::CameraFrame away = camera({0, 0, 4}, {0, 0, 8});
  const Pixels warped = warp(frame, nullptr, away, kBackground);
  EXPECT_EQ(pixel_of(warped, kFrameWidth / 2, kFrameHeight / 2), kBackgroundColor);
}

TEST(Warp, ExtremeDepthsAndCamerasDoNoHarm) {
  WarpFrame frame = draw(square, camera({0, 0, 4}, {0, 0, 0}));
  for (const float factor : {1e-17F, 1e17F}) {
    WarpFrame extreme = frame;
    for (MeshTriangle& triangle : extreme.mesh) {
      for (MeshVertex& vertex : triangle.corners) vertex.inverse *= vertex.pixel.x > 100 ? factor : 1;
    }
    for (const double step : {1e-12, 1.0, 1e12}) {
      const geometry::CameraFrame to = camera({step, step, 4}, {step, 0, 0});
      EXPECT_EQ(warp(extreme, &frame, to, kBackground).bytes.size(), size_t{4} * kFrameWidth * kFrameHeight);
    }
  }
}

TEST(Warp, PartsBehindTheEyeAreLeftOut) {
  const WarpFrame frame = draw(wall, camera({0, 0, 4}, {0, 0, 0}));
  const geometry::CameraFrame inside = camera({0, 0, -1}, {0, 0, -5});
  const Pixels warped = warp(frame, nullptr, inside, kBackground);
  for (int x = 0; x < kFrameWidth; ++x) EXPECT_EQ(pixel_of(warped, x, kFrameHeight / 2), kBackgroundColor);
}

}  // namespace
}  // namespace surfcast::warp
