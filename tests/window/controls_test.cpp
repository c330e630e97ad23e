#include "client/window/controls.h"

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

namespace surfcast {
namespace {

Pose start() {
  return {.position = {0, -10, 3}, .focal_point = {0, 0, 0}, .up = {0, 0, 1}, .view_angle = 30};
}

double distance(const Pose& pose) {
  return glm::length(pose.focal_point - pose.position);
}

TEST(Controls, APointerThatHoldsNothingMovesNothing) {
  Controls controls(start());
  controls.move({100, 50});
  EXPECT_FALSE(controls.moving());
  EXPECT_EQ(controls.pose().position, start().position);
}

TEST(Controls, ADragTurnsUntilTheButtonIsReleased) {
  Controls controls(start());
  controls.press(Controls::Drag::kOrbit);
  EXPECT_TRUE(controls.moving());
  controls.move({100, 0});
  const Pose turned = controls.pose();
  EXPECT_NE(turned.position, start().position);
  EXPECT_EQ(turned.focal_point, start().focal_point);
  controls.release();
  controls.move({100, 0});
  EXPECT_FALSE(controls.moving());
  EXPECT_EQ(controls.pose().position, turned.position);
}

TEST(Controls, OtherButtonsMoveAndLook) {
  Controls panning(start());
  panning.press(Controls::Drag::kPan);
  panning.move({0, 72});
  EXPECT_NE(panning.pose().focal_point, start().focal_point);
  EXPECT_NEAR(distance(panning.pose()), distance(start()), 1e-9);
  Controls looking(start());
  looking.press(Controls::Drag::kLook);
  looking.move({50, 0});
  EXPECT_EQ(looking.pose().position, start().position);
  EXPECT_NE(looking.pose().focal_point, start().focal_point);
}

TEST(Controls, TheWheelComesNearerToWhatIsUnderThePointer) {
  Controls controls(start());
  controls.resize(1000, 500);
  controls.wheel(1, {500, 250});
  EXPECT_LT(distance(controls.pose()), distance(start()));
  EXPECT_LT(glm::length(controls.pose().focal_point), 1e-9);
  controls.wheel(1, {900, 250});
  EXPECT_GT(controls.pose().focal_point.x, 0);
}

TEST(Controls, FlightGoesOnAsLongAsAKeyIsHeld) {
  Controls controls(start());
  controls.fly({0, 0, 1}, /*fast=*/false);
  EXPECT_TRUE(controls.moving());
  controls.advance(0.5, 4);
  EXPECT_NEAR(glm::length(controls.pose().position - start().position), 2, 1e-9);
  controls.fly({0, 0, 0}, false);
  controls.advance(0.5, 4);
  EXPECT_FALSE(controls.moving());
  EXPECT_NEAR(glm::length(controls.pose().position - start().position), 2, 1e-9);
}

TEST(Controls, HomeIsTheFirstView) {
  Controls controls(start());
  controls.nudge({1, 1});
  EXPECT_NE(controls.pose().position, start().position);
  controls.go_home();
  EXPECT_EQ(controls.pose().position, start().position);
}

}  // namespace
}  // namespace surfcast
