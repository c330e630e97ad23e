#include "client/window/controls.h"

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

namespace surfcast::window {
namespace {

client::Pose start() {
  return {.position = {0, -10, 3}, .focal_point = {0, 0, 0}, .up = {0, 0, 1}, .view_angle = 30};
}

Subject street() {
  Subject subject;
  subject.bounds.include({-20, -4, -1});
  subject.bounds.include({20, 4, 9});
  return subject;
}

double distance(const client::Pose& pose) {
  return glm::length(pose.focal_point - pose.position);
}

TEST(Controls, APointerThatHoldsNothingMovesNothing) {
  Controls controls(start(), street());
  controls.move({100, 50});
  EXPECT_FALSE(controls.moving());
  EXPECT_EQ(controls.pose().position, start().position);
}

TEST(Controls, ADragTurnsUntilTheButtonIsReleased) {
  Controls controls(start(), street());
  controls.press(Controls::Drag::kOrbit);
  EXPECT_TRUE(controls.moving());
  controls.move({100, 0});
  const client::Pose turned = controls.pose();
  EXPECT_NE(turned.position, start().position);
  EXPECT_EQ(turned.focal_point, start().focal_point);
  controls.release();
  controls.move({100, 0});
  EXPECT_FALSE(controls.moving());
  EXPECT_EQ(controls.pose().position, turned.position);
}

TEST(Controls, OtherButtonsMoveAndLook) {
  Controls panning(start(), street());
  panning.press(Controls::Drag::kPan);
  panning.move({0, 72});
  EXPECT_NE(panning.pose().focal_point, start().focal_point);
  EXPECT_NEAR(distance(panning.pose()), distance(start()), 1e-9);
  Controls looking(start(), street());
  looking.press(Controls::Drag::kLook);
  looking.move({50, 0});
  EXPECT_EQ(looking.pose().position, start().position);
  EXPECT_NE(looking.pose().focal_point, start().focal_point);
}

TEST(Controls, TheWheelComesNearerToWhatIsUnderThePointer) {
  Controls controls(start(), street());
  controls.resize(1000, 500);
  controls.wheel(1, {500, 250});
  EXPECT_LT(distance(controls.pose()), distance(start()));
  EXPECT_LT(glm::length(controls.pose().focal_point), 1e-9);
  controls.wheel(1, {900, 250});
  EXPECT_GT(controls.pose().focal_point.x, 0);
}

TEST(Controls, FlightGoesOnAsLongAsAKeyIsHeld) {
  Controls controls(start(), street());
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
  Controls controls(start(), street());
  controls.nudge(Controls::Drag::kOrbit, {1, 1});
  EXPECT_NE(controls.pose().position, start().position);
  controls.go_home();
  EXPECT_EQ(controls.pose().position, start().position);
}

TEST(Controls, UsualSidesShowTheWholeModel) {
  Controls controls(start(), street());
  controls.resize(1000, 500);
  controls.set_standard_view(StandardView::kFront);
  EXPECT_LT(controls.pose().position.y, -4);
  EXPECT_NEAR(controls.pose().position.x, 0, 1e-9);
  controls.set_standard_view(StandardView::kRight);
  EXPECT_GT(controls.pose().position.x, 20);
  controls.set_standard_view(StandardView::kTop);
  EXPECT_GT(controls.pose().position.z, 9);
  EXPECT_EQ(controls.pose().up, glm::dvec3(0, 0, 1));
  const double from_above = distance(controls.pose());
  controls.set_standard_view(StandardView::kLeft);
  EXPECT_LT(distance(controls.pose()), from_above);  // its narrow side
}

TEST(Controls, TheFrontOfAModelThatStandsOnItsYAxisFacesZ) {
  Subject subject = street();
  subject.z_up = false;
  Controls controls(start(), subject);
  controls.set_standard_view(StandardView::kFront);
  EXPECT_GT(controls.pose().position.z, 9);
  EXPECT_EQ(controls.pose().up, glm::dvec3(0, 1, 0));
}

TEST(Controls, FittingKeepsTheDirectionAndShowsAll) {
  Controls controls(start(), street());
  controls.nudge(Controls::Drag::kPan, {5, 5});
  const glm::dvec3 before = glm::normalize(controls.pose().focal_point - controls.pose().position);
  controls.fit();
  const glm::dvec3 after = glm::normalize(controls.pose().focal_point - controls.pose().position);
  EXPECT_LT(glm::length(after - before), 1e-9);
  EXPECT_GT(distance(controls.pose()), 20);
  Controls nearer = controls;
  nearer.step(3);
  nearer.fit();
  EXPECT_NEAR(distance(nearer.pose()), distance(controls.pose()), 1e-9);
}

TEST(Controls, ADoubleClickAsksOnceAndWhatItFindsComesIntoTheMiddle) {
  Controls controls(start(), street());
  controls.resize(1000, 500);
  EXPECT_FALSE(controls.take_focus_request());
  controls.double_click({250, 100});
  EXPECT_FALSE(controls.moving());
  EXPECT_EQ(controls.take_focus_request(), glm::dvec2(0.25, 0.2));
  EXPECT_FALSE(controls.take_focus_request());
  controls.focus_on({3, -1, 2});
  EXPECT_EQ(controls.pose().focal_point, glm::dvec3(3, -1, 2));
  EXPECT_NEAR(distance(controls.pose()), glm::length(glm::dvec3(3, -1, 2) - start().position) / 3, 1e-9);
}

}  // namespace
}  // namespace surfcast::window
