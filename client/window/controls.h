#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>

#include "client/navigation.h"
#include "client/window/standard_views.h"

namespace surfcast::window {

/// What the hand does to a pose. Positions are pixels of the window from its upper left corner.
class Controls {
 public:
  enum class Drag { kOrbit, kPan, kLook };

  Controls(const client::Pose& start, const Subject& subject) : subject_(subject), home_(start), pose_(start) {}

  void resize(int width, int height) { size_ = {width, height}; }
  void press(Drag drag) { drag_ = drag; }
  void release() { drag_.reset(); }
  /// The pointer has moved by so many pixels.
  void move(const glm::dvec2& pixels);
  /// A wheel's clicks, away from the hand: towards what is under the pointer.
  void wheel(double clicks, const glm::dvec2& pointer);
  /// Directions of flight as long as keys are held: to the right, up, forwards, each -1, 0 or 1.
  void fly(const glm::dvec3& course, bool fast) { course_ = course * (fast ? 4.0 : 1.0); }
  /// One press of an arrow key, to the right and up: a small drag of that kind.
  void nudge(Drag drag, const glm::dvec2& by);
  /// Clicks of the wheel, towards the middle.
  void step(double clicks) { wheel(clicks, size_ / 2.0); }
  void go_home() { pose_ = home_; }
  void fit() { pose_ = fit_pose(pose_, subject_, aspect()); }
  void set_standard_view(StandardView view) { pose_ = standard_pose(view, pose_, subject_, aspect()); }

  /// What is under the pointer shall come into the middle.
  void double_click(const glm::dvec2& pointer) { focus_request_ = pointer / size_; }
  /// Where that is, once: in parts of the picture's width and height from its upper left corner.
  std::optional<glm::dvec2> take_focus_request() { return std::exchange(focus_request_, std::nullopt); }
  void focus_on(const glm::dvec3& point) { pose_ = client::focus(pose_, point); }

  /// Lets time pass. `speed` is that of flight, world units per second.
  void advance(double seconds, double speed);

  [[nodiscard]] const client::Pose& pose() const { return pose_; }
  /// The pose is about to change further.
  [[nodiscard]] bool moving() const { return drag_.has_value() || course_ != glm::dvec3(0); }

 private:
  [[nodiscard]] double aspect() const { return size_.x / size_.y; }
  void drag(Drag drag, const glm::dvec2& by);

  Subject subject_;
  client::Pose home_;
  client::Pose pose_;
  glm::dvec2 size_{1280, 720};
  std::optional<Drag> drag_;
  glm::dvec3 course_{0};
  std::optional<glm::dvec2> focus_request_;
};

}  // namespace surfcast::window
