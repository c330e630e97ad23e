#include "service/shader_warm_up.h"

#include <algorithm>

#include "service/first_look.h"

namespace surfcast::service {
namespace {

constexpr int kDepthTexels = 8;

/// Adds a picture at rest and one in motion, the latter for clients that warp, too.
void add_both(picture::PictureRequest request, std::vector<picture::PictureRequest>& pictures) {
  pictures.push_back(request);
  request.normalization = picture::Normalization::kSurfel;
  request.blends_behind = true;
  pictures.push_back(request);
  request.depth_texels = kDepthTexels;
  pictures.push_back(request);
}

}  // namespace

std::vector<picture::PictureRequest> shader_warm_up_requests(const model::ModelFile& model) {
  const model::ModelInfo& info = model.info();
  picture::PictureRequest plain;
  plain.width = 16;
  plain.height = 16;
  plain.spacing = 1e6;  // the coarsest blocks
  plain.silhouettes = true;
  std::vector<picture::PictureRequest> pictures;
  const picture::PictureRequest first = with_first_look(plain, info);
  add_both(first, pictures);
  pictures.push_back(first);
  pictures.back().surveyed = true;
  if (!model.ellipsoid_sources().empty()) {
    picture::PictureRequest superquadrics = plain;
    superquadrics.glyphs.shape = picture::GlyphShape::kSuperquadric;
    add_both(superquadrics, pictures);
  }
  const auto colored_by = [&](picture::SurfelColor color) {
    picture::PictureRequest request = plain;
    request.coloring.source = color;
    add_both(request, pictures);
  };
  const auto has = [&](const char* name) { return std::ranges::count(info.scalar_names, name) > 0; };
  if (has("classification")) colored_by(picture::SurfelColor::kClassification);
  if (has("intensity")) colored_by(picture::SurfelColor::kIntensity);
  colored_by(picture::SurfelColor::kElevation);
  colored_by(picture::SurfelColor::kNormal);
  picture::PictureRequest shaded = plain;
  shaded.eye_dome.strength = 1;
  add_both(shaded, pictures);
  picture::PictureRequest clipped = plain;
  clipped.clip.inside.push_back(info.bounds);
  add_both(clipped, pictures);
  return pictures;
}

}  // namespace surfcast::service
