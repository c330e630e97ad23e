#include "client/window/controls.h"

#include <cmath>

namespace surfcast::window {
namespace {

constexpr double kFactorPerClick = 0.85;
constexpr double kNudge = 1.0 / 24;  // of the picture's height

}  // namespace

void Controls::drag(Drag drag, const glm::dvec2& by) {
  switch (drag) {
    case Drag::kOrbit:
      pose_ = client::orbit(pose_, by);
      break;
    case Drag::kPan:
      pose_ = client::pan(pose_, by);
      break;
    case Drag::kLook:
      pose_ = client::look(pose_, by);
      break;
  }
}

void Controls::move(const glm::dvec2& pixels) {
  if (drag_) drag(*drag_, glm::dvec2(pixels.x, -pixels.y) / size_.y);
}

void Controls::wheel(double clicks, const glm::dvec2& pointer) {
  const glm::dvec2 cursor = glm::dvec2(pointer.x - size_.x / 2, size_.y / 2 - pointer.y) / size_.y;
  pose_ = client::zoom(pose_, std::pow(kFactorPerClick, clicks), cursor);
}

void Controls::nudge(Drag kind, const glm::dvec2& by) {
  drag(kind, by * kNudge);
}

void Controls::advance(double seconds, double speed) {
  if (course_ != glm::dvec3(0)) pose_ = surfcast::client::fly(pose_, course_ * (speed * seconds));
}

}  // namespace surfcast::window
