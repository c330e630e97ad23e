#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "client/navigation.h"

namespace surfcast {

/// What the hand does to a pose. Positions are pixels of the window from its upper left corner.
class Controls {
 public:
  enum class Drag { kOrbit, kPan, kLook };

  explicit Controls(const Pose& start) : home_(start), pose_(start) {}

  void resize(int width, int height) { size_ = {width, height}; }
  void press(Drag drag) { drag_ = drag; }
  void release() { drag_.reset(); }
  /// The pointer has moved by so many pixels.
  void move(const glm::dvec2& pixels);
  /// A wheel's clicks, away from the hand: towards what is under the pointer.
  void wheel(double clicks, const glm::dvec2& pointer);
  /// Directions of flight as long as keys are held: to the right, up, forwards, each -1, 0 or 1.
  void fly(const glm::dvec3& course, bool fast) { course_ = course * (fast ? 4.0 : 1.0); }
  /// One press of an arrow key: to the right and up.
  void nudge(const glm::dvec2& by);
  void go_home() { pose_ = home_; }

  /// Lets time pass. `speed` is that of flight, world units per second.
  void advance(double seconds, double speed);

  [[nodiscard]] const Pose& pose() const { return pose_; }
  /// The pose is about to change further.
  [[nodiscard]] bool moving() const { return drag_.has_value() || course_ != glm::dvec3(0); }

 private:
  Pose home_;
  Pose pose_;
  glm::dvec2 size_{1280, 720};
  std::optional<Drag> drag_;
  glm::dvec3 course_{0};
};

}  // namespace surfcast
