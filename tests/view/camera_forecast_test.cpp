#include "view/camera_forecast.h"

#include <cmath>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

namespace surfcast::view {
namespace {

using std::chrono::milliseconds;

/// A camera as pictures see it: eye and axes.
void expect_same(const geometry::Camera& a, const geometry::Camera& b, double tolerance) {
  const auto x = geometry::make_camera_frame(a, 10, 10);
  const auto y = geometry::make_camera_frame(b, 10, 10);
  ASSERT_TRUE(x && y);
  EXPECT_LT(glm::length(x->eye - y->eye), tolerance);
  EXPECT_LT(glm::length(x->right - y->right), tolerance);
  EXPECT_LT(glm::length(x->forward - y->forward), tolerance);
  EXPECT_EQ(x->eta, y->eta);
}

geometry::Camera orbiting(double angle, const glm::dvec3& centre = {0, 0, 0}) {
  const glm::dvec3 offset(5 * std::cos(angle), 5 * std::sin(angle), 2);
  return {centre + offset, centre, {0, 0, 1}, 40};
}

geometry::Camera turning(double angle) {
  return {{1, 2, 3}, {1 + std::cos(angle), 2 + std::sin(angle), 3.2}, {0, 0, 1}, 40};
}

geometry::Camera gliding(double step) {
  return {{step, 2 * step, 3}, {step, 2 * step + 4, 3 + 0.5}, {0, 0, 1}, 40};
}

TEST(ContinuedMotion, IsExactForOrbitsTurnsAndTranslations) {
  for (const double steps : {0.0, 0.5, 1.0, 4.0}) {
    expect_same(continue_motion(orbiting(0.3), orbiting(0.4), steps), orbiting(0.4 + 0.1 * steps), 1e-12);
    expect_same(continue_motion(turning(0.3), turning(0.4), steps), turning(0.4 + 0.1 * steps), 1e-12);
    expect_same(continue_motion(gliding(0.3), gliding(0.4), steps), gliding(0.4 + 0.1 * steps), 1e-12);
  }
}

TEST(ContinuedMotion, IsExactFarFromTheOrigin) {
  const glm::dvec3 centre(500000, 5400000, 300);
  expect_same(continue_motion(orbiting(0.3, centre), orbiting(0.301, centre), 10), orbiting(0.311, centre), 1e-5);
}

TEST(ContinuedMotion, OfTheSameCameraStaysThere) {
  expect_same(continue_motion(orbiting(0.3), orbiting(0.3), 7), orbiting(0.3), 1e-14);
}

TEST(ContinuedMotion, OfTurnsTooSmallToMeasureStaysFinite) {
  expect_same(continue_motion(orbiting(0.3), orbiting(0.3 + 1e-13), 5), orbiting(0.3), 1e-9);
}

TEST(ContinuedMotion, OfAJumpIsNone) {
  expect_same(continue_motion(orbiting(0), orbiting(2), 1), orbiting(2), 1e-14);
  geometry::Camera invalid = orbiting(0);
  invalid.focal_point = invalid.position;
  expect_same(continue_motion(invalid, orbiting(0.1), 1), orbiting(0.1), 1e-14);
}

TEST(CameraForecastTest, FollowsAMotion) {
  CameraForecast forecast;
  const ViewTime start{};
  // A tenth of a radian in 100 ms, with uneven steps.
  for (const int ms : {0, 10, 32, 41, 70, 100}) forecast.record(orbiting(1e-3 * ms), start + milliseconds(ms));
  const ViewTime now = start + milliseconds(100);
  expect_same(forecast.at(now, now), orbiting(0.1), 1e-12);
  expect_same(forecast.at(now + milliseconds(150), now), orbiting(0.25), 1e-12);
}

TEST(CameraForecastTest, IsBounded) {
  CameraForecast forecast;
  const ViewTime start{};
  forecast.record(orbiting(0), start);
  forecast.record(orbiting(0.01), start + milliseconds(10));
  const ViewTime now = start + milliseconds(10);
  expect_same(forecast.at(now + std::chrono::hours(1), now), forecast.at(now + CameraForecast::kFarthest, now), 1e-12);
}

TEST(CameraForecastTest, IsBoundedWhereTwoCamerasArriveAtOnce) {
  CameraForecast forecast;
  const ViewTime start{};
  forecast.record(orbiting(0), start);
  forecast.record(orbiting(0.01), start + std::chrono::microseconds(10));
  expect_same(forecast.at(start + milliseconds(66), start), orbiting(0.03), 1e-4);
  EXPECT_LT(glm::distance(forecast.at(start + CameraForecast::kFarthest, start).position, orbiting(0.1).position),
            0.01);
}

TEST(CameraForecastTest, ForgetsWhatWasBeforeThePresentMotion) {
  CameraForecast forecast;
  const ViewTime start{};
  forecast.record(orbiting(0), start);
  forecast.record(orbiting(0.1), start + milliseconds(20));
  // The same motion has gone on for longer than the window at another speed.
  for (int ms = 40; ms <= 400; ms += 20) forecast.record(orbiting(0.1 + 1e-4 * ms), start + milliseconds(ms));
  const ViewTime now = start + milliseconds(400);
  expect_same(forecast.at(now + milliseconds(100), now), orbiting(0.15), 1e-12);
}

TEST(CameraForecastTest, StaysWhereACameraStays) {
  CameraForecast forecast;
  const ViewTime start{};
  forecast.record(orbiting(0.2), start);
  expect_same(forecast.at(start + milliseconds(50), start), orbiting(0.2), 1e-14);
  forecast.record(orbiting(0.3), start + milliseconds(20));
  const ViewTime late = start + milliseconds(500);
  expect_same(forecast.at(late + milliseconds(100), late), orbiting(0.3), 1e-14);
  forecast.record(orbiting(0.4), late);  // a new motion begins
  expect_same(forecast.at(late + milliseconds(100), late), orbiting(0.4), 1e-14);
}

}  // namespace
}  // namespace surfcast::view
