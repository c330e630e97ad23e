#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>

#include "client/navigation.h"
#include "client/window/standard_views.h"

namespace surfcast::window {

/// Applies mouse and key input to a pose. Positions are in pixels from the upper left corner of the window.
class Controls {
 public:
  enum class Drag { kOrbit, kPan, kLook };

  Controls(const client::Pose& start, const Subject& subject) : subject_(subject), home_(start), pose_(start) {}

  void resize(int width, int height) { size_ = {width, height}; }
  void press(Drag drag) { drag_ = drag; }
  void release() { drag_.reset(); }
  /// The pointer has moved by `pixels`.
  void move(const glm::dvec2& pixels);
  /// Clicks of the wheel; positive values zoom towards the point under the pointer.
  void wheel(double clicks, const glm::dvec2& pointer);
  /// Direction of flight while keys are held: to the right, up, forwards, each -1, 0 or 1.
  void fly(const glm::dvec3& course, bool fast) { course_ = course * (fast ? 4.0 : 1.0); }
  /// One press of an arrow key: a small drag in direction `by` (to the right, up).
  void nudge(Drag drag, const glm::dvec2& by);
  /// Clicks of the wheel, towards the centre of the picture.
  void step(double clicks) { wheel(clicks, size_ / 2.0); }
  void go_home() { pose_ = home_; }
  void fit() { pose_ = fit_pose(pose_, subject_, aspect()); }
  void set_standard_view(StandardView view) { pose_ = standard_pose(view, pose_, subject_, aspect()); }

  /// Requests that the point under the pointer becomes the centre of the view.
  void double_click(const glm::dvec2& pointer) { focus_request_ = pointer / size_; }
  /// The position of the last double click, once: as fractions of the picture's width and height from its upper left
  /// corner.
  std::optional<glm::dvec2> take_focus_request() { return std::exchange(focus_request_, std::nullopt); }
  void focus_on(const glm::dvec3& point) { pose_ = client::focus(pose_, point); }

  /// Advances the flight by `seconds`. `speed` is in world units per second.
  void advance(double seconds, double speed);

  [[nodiscard]] const client::Pose& pose() const { return pose_; }
  /// Whether a drag or a flight is in progress.
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
