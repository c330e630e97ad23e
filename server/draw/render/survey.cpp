#include "render/survey.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace surfcast::render {
namespace {

bool same_poses(const geometry::CameraFrame& a, const geometry::CameraFrame& b) {
  return a.eye == b.eye && a.right == b.right && a.up == b.up && a.forward == b.forward;
}

bool same_frames(const geometry::CameraFrame& a, const geometry::CameraFrame& b) {
  return same_poses(a, b) && a.eta == b.eta && a.width == b.width && a.height == b.height;
}

/// Whether the pictures have the same borders, within a pixel of the smaller one: sizes are rounded.
bool same_borders(const geometry::CameraFrame& a, const geometry::CameraFrame& b) {
  const double pixel = 1 / std::min(a.eta, b.eta);
  return std::abs(a.width / a.eta - b.width / b.eta) <= pixel && std::abs(a.height / a.eta - b.height / b.eta) <= pixel;
}

bool same_boxes(const std::vector<geometry::Box>& a, const std::vector<geometry::Box>& b) {
  return std::ranges::equal(
      a, b, [](const geometry::Box& x, const geometry::Box& y) { return x.min == y.min && x.max == y.max; });
}

/// Whether both show the same of what is in view.
bool same_surfaces(const ShownPart& a, const ShownPart& b) {
  return same_boxes(a.clip.inside, b.clip.inside) && same_boxes(a.clip.outside, b.clip.outside) &&
         a.hidden_classes == b.hidden_classes && a.hidden_models == b.hidden_models;
}

}  // namespace

bool ShownPart::operator==(const ShownPart& other) const {
  return same_frames(frame, other.frame) && spacing == other.spacing && same_surfaces(*this, other);
}

double survey_spacing(double spacing) {
  constexpr double kFactor = 8;  // 1/64 of the surfels of a surface
  return kFactor * spacing;
}

double surfels_worth_a_survey(int width, int height, double spacing) {
  constexpr double kLayers = 7;
  return kLayers * width * height / (spacing * spacing);
}

Surveys::Found Surveys::find(const ShownPart& shown) {
  const auto found = std::ranges::find(surveys_, shown, &Survey::shown);
  if (found == surveys_.end()) return nullptr;
  surveys_.splice(surveys_.begin(), surveys_, found);
  return found->visible;
}

Surveys::Found Surveys::find_from_camera(const ShownPart& shown) const {
  const auto found = std::ranges::find_if(surveys_, [&](const Survey& survey) {
    const geometry::CameraFrame& frame = survey.shown.frame;
    return same_poses(frame, shown.frame) && same_borders(frame, shown.frame) && same_surfaces(survey.shown, shown);
  });
  return found == surveys_.end() ? nullptr : found->visible;
}

void Surveys::keep(ShownPart shown, Found visible) {
  constexpr size_t kMost = 4;  // views that sharpen at the same time
  if (surveys_.size() == kMost) surveys_.pop_back();
  surveys_.push_front({std::move(shown), std::move(visible)});
}

}  // namespace surfcast::render
