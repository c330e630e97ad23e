#include "service/rehearsal.h"

#include <algorithm>

namespace surfcast {
namespace {

/// One at rest and one in motion.
void add_both(PictureRequest request, std::vector<PictureRequest>& pictures) {
  pictures.push_back(request);
  request.normalization = Normalization::kSurfel;
  pictures.push_back(request);
}

}  // namespace

std::vector<PictureRequest> rehearsal_of(const ModelInfo& info) {
  PictureRequest plain;
  plain.width = 16;
  plain.height = 16;
  plain.spacing = 1e6;  // the coarsest blocks
  plain.silhouettes = true;
  std::vector<PictureRequest> pictures;
  add_both(plain, pictures);
  const auto colored_by = [&](SurfelColor color) {
    PictureRequest request = plain;
    request.coloring.source = color;
    add_both(request, pictures);
  };
  const auto has = [&](const char* name) { return std::ranges::count(info.scalar_names, name) > 0; };
  if (has("classification")) colored_by(SurfelColor::kClassification);
  if (has("intensity")) colored_by(SurfelColor::kIntensity);
  colored_by(SurfelColor::kElevation);
  colored_by(SurfelColor::kNormal);
  PictureRequest shaded = plain;
  shaded.eye_dome.strength = 1;
  add_both(shaded, pictures);
  PictureRequest clipped = plain;
  clipped.clip.inside.push_back(info.bounds);
  add_both(clipped, pictures);
  return pictures;
}

}  // namespace surfcast
