#include "render/variant_of_picture.h"

#include "surfel/curvature.h"

namespace surfcast::render {
namespace {

/// True if the colours do not show the shape, so lighting is needed.
bool lit_by_default(const model::ModelInfo& info, const DisplayOptions& display) {
  if (display.color == picture::SurfelColor::kStored) return info.color_bits == 0;
  return display.color == picture::SurfelColor::kElevation || display.color == picture::SurfelColor::kClassification;
}

/// Chooses the programs of surfels that are seen through.
void set_transparency(const DisplayOptions& display, const picture::PictureRequest& request, Variant& variant) {
  variant.transparent = display.through.any;
  if (!display.through.any) return;
  variant.by_file = display.through.by_file;
  variant.by_class = display.through.by_class;
  variant.ghosts = display.through.ghosts;
  variant.xray = request.xray == picture::XRay::kSorted;
  variant.density = request.xray == picture::XRay::kDensity;
  variant.silhouettes = false;
}

}  // namespace

Variant variant_of(const model::ModelInfo& info, const DisplayOptions& display,
                   const picture::PictureRequest& request) {
  Variant variant;
  variant.colored = info.color_bits > 0 || display.color != picture::SurfelColor::kStored;
  variant.lit = request.shading == picture::Shading::kLit ||
                (request.shading == picture::Shading::kAuto && lit_by_default(info, display));
  variant.float_picture = request.format == picture::PixelFormat::kLinearFloat;
  variant.color = display.color;
  variant.hides_classes = display.hides_classes;
  variant.clipped = display.clipped;
  variant.scatter = info.scatter > 0;
  variant.curved = surfel::has_curvature(info.scalar_names);
  variant.shaded = request.volumes.shaded;
  variant.volume_surfaces = !display.volumes.isos.empty() || !display.volumes.slices.empty();
  variant.eye_dome = request.eye_dome.strength > 0;
  variant.blends_behind = request.blends_behind;
  variant.exact = request.splat_convention == picture::SplatConvention::kExact && !request.rest_spacing;
  variant.superquadrics = request.glyphs.shape == picture::GlyphShape::kSuperquadric;
  variant.silhouettes = request.silhouettes && request.normalization == picture::Normalization::kPixel &&
                        request.filter == picture::Filter::kEwa;
  set_transparency(display, request, variant);
  return variant;
}

}  // namespace surfcast::render
