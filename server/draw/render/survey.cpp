#include "render/survey.h"

#include <algorithm>
#include <utility>

namespace surfcast::render {
namespace {

bool same_frames(const geometry::CameraFrame& a, const geometry::CameraFrame& b) {
  return a.eye == b.eye && a.right == b.right && a.up == b.up && a.forward == b.forward && a.eta == b.eta &&
         a.width == b.width && a.height == b.height;
}

bool same_boxes(const std::vector<geometry::Box>& a, const std::vector<geometry::Box>& b) {
  return std::ranges::equal(
      a, b, [](const geometry::Box& x, const geometry::Box& y) { return x.min == y.min && x.max == y.max; });
}

}  // namespace

bool ShownPart::operator==(const ShownPart& other) const {
  return same_frames(frame, other.frame) && spacing == other.spacing && same_boxes(clip.inside, other.clip.inside) &&
         same_boxes(clip.outside, other.clip.outside) && hidden_classes == other.hidden_classes &&
         hidden_models == other.hidden_models;
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

void Surveys::keep(ShownPart shown, Found visible) {
  constexpr size_t kMost = 4;  // views that sharpen at the same time
  if (surveys_.size() == kMost) surveys_.pop_back();
  surveys_.push_front({std::move(shown), std::move(visible)});
}

}  // namespace surfcast::render
