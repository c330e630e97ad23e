#include "geometry/fit_camera.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::geometry {
namespace {

Box box_between(const glm::dvec3& first, const glm::dvec3& second) {
  Box box;
  box.include(first);
  box.include(second);
  return box;
}

glm::dvec3 corner_of(const Box& box, int corner) {
  return {(corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
          (corner & 4) ? box.max.z : box.min.z};
}

/// Where the corners of the boxes are in a picture, in parts of it: within [0, 1] is all that is seen.
Box seen(std::span<const Box> boxes, const Camera& camera, double aspect) {
  const int height = 400;
  const int width = static_cast<int>(height * aspect);
  const Result<CameraFrame> frame = make_camera_frame(camera, width, height);
  Box seen;
  for (const Box& box : boxes) {
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 q = frame->to_camera(corner_of(box, corner));
      EXPECT_GT(q.z, 0);
      const glm::dvec2 pixel = frame->project(q);
      seen.include({pixel.x / width, pixel.y / height, 0});
    }
  }
  return seen;
}

TEST(FitCamera, WhatIsFittedTouchesTheMarginOnTwoSides) {
  const std::vector<Box> flat = {box_between({100, 200, 300}, {104, 207, 301})};
  const std::vector<Box> street = {box_between({0, 0, 0}, {30, 2, 1})};
  const std::vector<Box> stairs = {box_between({0, 0, 0}, {1, 1, 1}), box_between({1, 1, 1}, {2, 2, 2}),
                                   box_between({2, 2, 2}, {3, 9, 3})};
  for (const std::vector<Box>& boxes : {flat, street, stairs}) {
    for (const double aspect : {0.3, 1.0, 2.5}) {
      for (const glm::dvec3 up : {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0)}) {
        const Box picture = seen(boxes, fit_camera(boxes, up, aspect), aspect);
        // The margin is a fortieth of the picture on each side, and what is fitted is in the middle.
        EXPECT_NEAR(std::max(picture.size().x, picture.size().y), 0.95, 0.001);
        EXPECT_GE(std::min(picture.min.x, picture.min.y), 0.0249);
        EXPECT_LE(std::max(picture.max.x, picture.max.y), 0.9751);
      }
    }
  }
}

TEST(FitCamera, EmptyCornersOfTheWholeTakeNoRoom) {
  const std::vector<Box> parts = {box_between({0, 0, 0}, {4, 4, 1}), box_between({2, 2, 1}, {2, 2, 9})};
  const std::vector<Box> whole = {box_between({0, 0, 0}, {4, 4, 9})};
  const auto distance = [](const std::vector<Box>& boxes) {
    const Camera camera = fit_camera(boxes, {0, 0, 1}, 1);
    return glm::length(camera.position - camera.focal_point);
  };
  EXPECT_LT(distance(parts), distance(whole));
}

TEST(FitCamera, TheEyeStandsWhereTheSurfaceShowsItsFront) {
  const std::vector<Box> boxes = {box_between({-1, -1, -1}, {1, 1, 1})};
  for (const glm::dvec3 facing : {glm::dvec3(0, 0, -0.9), glm::dvec3(0, 0.9, 0), glm::dvec3(-0.9, 0, 0)}) {
    const Camera camera = fit_camera(boxes, {0, 0, 1}, 1, 30, facing);
    EXPECT_GT(glm::dot(glm::normalize(camera.position), facing), 0.1);
  }
}

TEST(FitCamera, APointHasAViewToo) {
  const std::vector<Box> boxes = {box_between({5, 6, 7}, {5, 6, 7})};
  EXPECT_TRUE(make_camera_frame(fit_camera(boxes, {0, 1, 0}, 1), 10, 10));
}

}  // namespace
}  // namespace surfcast::geometry
