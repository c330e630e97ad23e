#include "client/window/controls.h"

#include <cmath>

namespace surfcast {
namespace {

constexpr double kFactorPerClick = 0.85;
constexpr double kNudge = 1.0 / 24;  // of the picture's height

}  // namespace

void Controls::move(const glm::dvec2& pixels) {
  if (!drag_) return;
  const glm::dvec2 drag = glm::dvec2(pixels.x, -pixels.y) / size_.y;
  switch (*drag_) {
    case Drag::kOrbit:
      pose_ = orbit(pose_, drag);
      break;
    case Drag::kPan:
      pose_ = pan(pose_, drag);
      break;
    case Drag::kLook:
      pose_ = look(pose_, drag);
      break;
  }
}

void Controls::wheel(double clicks, const glm::dvec2& pointer) {
  const glm::dvec2 cursor = glm::dvec2(pointer.x - size_.x / 2, size_.y / 2 - pointer.y) / size_.y;
  pose_ = zoom(pose_, std::pow(kFactorPerClick, clicks), cursor);
}

void Controls::nudge(const glm::dvec2& by) {
  pose_ = orbit(pose_, by * kNudge);
}

void Controls::advance(double seconds, double speed) {
  if (course_ != glm::dvec3(0)) pose_ = surfcast::fly(pose_, course_ * (speed * seconds));
}

}  // namespace surfcast
