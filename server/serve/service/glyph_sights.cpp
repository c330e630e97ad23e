#include "service/glyph_sights.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "render/glyph_plan.h"

namespace surfcast::service {
namespace {

kinds::GlyphMeasure measure_of(picture::GlyphRadius radius) {
  switch (radius) {
    case picture::GlyphRadius::kRoot:
      return kinds::GlyphMeasure::kRoot;
    case picture::GlyphRadius::kUnit:
      return kinds::GlyphMeasure::kUnit;
    case picture::GlyphRadius::kEigenvalue:
      break;
  }
  return kinds::GlyphMeasure::kEigenvalue;
}

/// The layer that a slice shows, as thick as the longest step of the grid along its normal.
kinds::GlyphSight::Layer layer_of(const picture::Slice& slice, const model::EllipsoidSource& source) {
  const glm::dmat3 steps(source.index_to_world);
  if (slice.axis) {
    return {source.index_to_world[3] + slice.index * steps[*slice.axis],
            glm::transpose(glm::inverse(steps))[*slice.axis]};
  }
  const glm::dvec3 along = glm::abs(slice.normal * steps);
  return {slice.point, slice.normal / std::max({along.x, along.y, along.z, 1e-300})};
}

kinds::GlyphSight sight_of(const model::EllipsoidSource& source, const picture::PictureRequest& request) {
  kinds::GlyphSight sight;
  sight.scale = render::glyph_scale(source, request.glyphs);
  sight.measure = measure_of(request.glyphs.radius);
  for (const picture::Threshold& threshold : request.glyphs.thresholds) {
    const int attribute = render::attribute_number(source, threshold.attribute);
    sight.ranges.push_back({attribute, threshold.smallest, threshold.largest});
  }
  if (!source.on_grid()) return sight;
  for (const picture::Slice& slice : request.volumes.slices) sight.layers.push_back(layer_of(slice, source));
  return sight;
}

}  // namespace

GlyphSights glyph_sights(const model::ModelFile& model, const picture::PictureRequest& request) {
  GlyphSights sights;
  for (const model::EllipsoidSource& source : model.ellipsoid_sources()) {
    sights.sights.push_back(sight_of(source, request));
    const glm::dvec3 largest(source.largest);
    sights.reach = std::max(sights.reach, sights.sights.back().semi_axes(largest).x);
  }
  return sights;
}

}  // namespace surfcast::service
