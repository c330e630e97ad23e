#pragma once

#include <span>
#include <string>
#include <vector>

#include "model/ellipsoid_source.h"
#include "render/region_task.h"
#include "shared/ellipsoid_layout.h"

namespace surfcast::render {

/// How the ellipsoids of a region are drawn: for each block of ProjectionWork::blocks, thresholds and planes.
struct GlyphPlan {
  std::vector<layout::GlyphView> views;
  std::vector<layout::GlyphThreshold> ranges;  ///< of the views, contiguous
  bool colored = false;                        ///< a view has colours from a table
};

/// The semi-axis of a value (or a root, or a ratio) of 1, world units.
double glyph_scale(const model::EllipsoidSource& source, const picture::GlyphOptions& glyphs);
/// The number of an attribute of a source (shared/ellipsoid_layout.h); -1 if it has none of this name.
int attribute_number(const model::EllipsoidSource& source, const std::string& name);

/// For each block of a model: the largest radius of the glyphs of a picture in it and in its descendants, as
/// BlockEntry::max_radius states it for pictures without options of glyphs. Empty if that is large enough.
std::vector<double> glyph_reaches(const model::ModelFile& model, const picture::GlyphOptions& glyphs);

/// The most glyphs of a picture in motion: so many of them for every surfel that a surface over the whole picture would
/// have at the same spacing. A field fills space: without a limit its glyphs would increase with the third power of the
/// resolution, most of them hidden behind others.
uint64_t most_glyphs(const picture::PictureRequest& request, uint32_t glyphs_per_surfel);

/// Sets the range of a coloured attribute. Fails if no source has the attribute of the colour or of a threshold.
Status resolve_glyphs(std::span<const model::EllipsoidSource> sources, const picture::PictureRequest& request,
                      DisplayOptions& display);

/// `unit`: see drawing_unit.
GlyphPlan plan_glyphs(const RegionTask& task, int unit);

/// The lights of a picture, for the shader.
struct GlyphLights {
  layout::GlyphLighting lighting;
  std::vector<layout::GlyphLight> lights;
};
GlyphLights lights_of(const picture::PictureRequest& request);

}  // namespace surfcast::render
