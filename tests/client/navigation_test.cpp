#include "client/navigation.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <gtest/gtest.h>

namespace surfcast::client {
namespace {

constexpr double kTiny = 1e-9;

/// In a survey's coordinates, looking down a little.
Pose surveyor() {
  return {.position = {500'000, 4'000'000, 120},
          .focal_point = {500'080, 4'000'060, 100},
          .up = {0, 0, 1},
          .view_angle = 40};
}

double distance(const Pose& pose) {
  return glm::length(pose.focal_point - pose.position);
}

/// Where a point appears, in heights of the picture from its middle.
glm::dvec2 on_picture(const Pose& pose, const glm::dvec3& point) {
  const glm::dvec3 forward = glm::normalize(pose.focal_point - pose.position);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, pose.up));
  const glm::dvec3 up = glm::cross(right, forward);
  const glm::dvec3 to = point - pose.position;
  const double height = 2 * glm::dot(to, forward) * std::tan(glm::radians(pose.view_angle) / 2);
  return {glm::dot(to, right) / height, glm::dot(to, up) / height};
}

TEST(Navigation, OrbitKeepsTheDistanceAndTheFocalPoint) {
  const Pose moved = orbit(surveyor(), {0.3, -0.2});
  EXPECT_EQ(moved.focal_point, surveyor().focal_point);
  EXPECT_NEAR(distance(moved), distance(surveyor()), 1e-6);
}

TEST(Navigation, ADragToTheRightTurnsWhatIsInFrontToTheRight) {
  const Pose pose = surveyor();
  const glm::dvec3 nearer = glm::mix(pose.position, pose.focal_point, 0.8);
  EXPECT_GT(on_picture(orbit(pose, {0.05, 0}), nearer).x, 0);
  EXPECT_GT(on_picture(orbit(pose, {0, 0.05}), nearer).y, 0);
}

TEST(Navigation, TwoHeightsAreAWholeTurn) {
  const Pose moved = orbit(surveyor(), {2, 0});
  EXPECT_LT(glm::length(moved.position - surveyor().position), 1e-6);
}

TEST(Navigation, ThePolesAreNeverReached) {
  for (const double drag : {-5.0, 5.0}) {
    Pose pose = surveyor();
    for (int i = 0; i < 10; ++i) pose = orbit(pose, {0.1, drag});
    const double sine = glm::dot(glm::normalize(pose.focal_point - pose.position), pose.up);
    EXPECT_LT(std::abs(sine), 1);
    EXPECT_GT(std::abs(sine), 0.99);
    EXPECT_TRUE(std::isfinite(pose.position.x));
  }
}

TEST(Navigation, WhatIsPannedFollowsTheHand) {
  const Pose moved = pan(surveyor(), {0.25, -0.1});
  const glm::dvec2 place = on_picture(moved, surveyor().focal_point);
  EXPECT_NEAR(place.x, 0.25, kTiny);
  EXPECT_NEAR(place.y, -0.1, kTiny);
}

TEST(Navigation, ZoomKeepsWhatIsUnderTheCursor) {
  const glm::dvec2 cursor{0.4, 0.2};
  const Pose before = surveyor();
  const glm::dvec3 under = pan(before, -cursor).focal_point;
  for (const double factor : {0.5, 0.9, 3.0}) {
    const Pose after = zoom(before, factor, cursor);
    EXPECT_NEAR(distance(after), factor * distance(before), 1e-6);
    EXPECT_NEAR(on_picture(after, under).x, cursor.x, 1e-6);
    EXPECT_NEAR(on_picture(after, under).y, cursor.y, 1e-6);
  }
}

TEST(Navigation, LookingAroundKeepsTheEye) {
  const Pose moved = look(surveyor(), {0.2, 0.1});
  EXPECT_EQ(moved.position, surveyor().position);
  EXPECT_NEAR(distance(moved), distance(surveyor()), 1e-6);
  EXPECT_LT(on_picture(moved, surveyor().focal_point).x, 0);
}

TEST(Navigation, FlyingForwardsPassesTheFocalPointOn) {
  const Pose moved = fly(surveyor(), {0, 0, 10});
  EXPECT_NEAR(glm::length(moved.position - surveyor().position), 10, 1e-6);
  EXPECT_NEAR(distance(moved), distance(surveyor()), 1e-6);
}

TEST(Navigation, ALineOfSightAlongTheVerticalAxisHasAPictureToo) {
  const Pose above{.position = {0, 0, 10}, .focal_point = {0, 0, 0}, .up = {0, 0, 1}, .view_angle = 30};
  for (const Pose& moved : {orbit(above, {0.1, 0.1}), pan(above, {0.1, 0.1}), zoom(above, 0.5, {0.1, 0.1})}) {
    EXPECT_TRUE(std::isfinite(moved.position.x + moved.position.y + moved.position.z));
  }
}

TEST(Navigation, CamerasComeBackAsTheyWere) {
  const Pose pose = to_pose(to_camera(surveyor()));
  EXPECT_EQ(pose.position, surveyor().position);
  EXPECT_EQ(pose.focal_point, surveyor().focal_point);
  EXPECT_EQ(pose.view_angle, surveyor().view_angle);
}

}  // namespace
}  // namespace surfcast::client
