#include "service/first_look.h"

namespace surfcast::service {
namespace {

constexpr double kEdges = 0.5;    // strength of eye-dome lighting: clear steps, and few specks on rough surfaces
constexpr double kDarkest = 0.6;  // of the range of intensities: where black would be, below their lowest value

/// Grey by intensity. The darkest points are not black: light makes them darker yet.
void color_by_intensity(const model::AttributeRange& range, picture::Coloring& coloring) {
  coloring.source = picture::SurfelColor::kIntensity;
  coloring.map = picture::ColorMap::kGray;
  if (!coloring.first) coloring.first = range.low - kDarkest * (range.high - range.low);
  if (!coloring.last) coloring.last = range.high;
}

}  // namespace

picture::PictureRequest with_first_look(picture::PictureRequest request, const model::ModelInfo& info) {
  const bool open = request.shading == picture::Shading::kAuto &&
                    request.coloring.source == picture::SurfelColor::kStored && info.color_bits == 0 &&
                    info.surfels > 0 && !info.even;
  if (!open) return request;
  const model::AttributeRange* const intensity = info.range_of("intensity");
  request.shading = picture::Shading::kLit;
  request.coloring.source = picture::SurfelColor::kElevation;
  if (intensity != nullptr && intensity->low < intensity->high) color_by_intensity(*intensity, request.coloring);
  if (request.eye_dome.strength == 0) request.eye_dome.strength = kEdges;
  return request;
}

}  // namespace surfcast::service
