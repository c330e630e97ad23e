#include "service/sights.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <memory>

#include "render/glyph_plan.h"
#include "render/transfer_function.h"
#include "render/transfer_presets.h"
#include "render/visible_parts.h"

namespace surfcast::service {
namespace {

/// The plane of a slice in the world.
kinds::VolumeSight::Plane plane_of(const picture::Slice& slice, const render::VolumePlace& place, double opacity) {
  if (!slice.axis) return {slice.point, slice.normal, opacity};
  const glm::dmat3 axes = place.axes();
  const int axis = *slice.axis;
  return {place.index_to_world[3] + slice.index * axes[axis], glm::cross(axes[(axis + 1) % 3], axes[(axis + 2) % 3]),
          opacity};
}

kinds::VolumeSight sight_of(const render::VolumeLook& look, const render::VolumePlace& place) {
  const auto medium = std::make_shared<const render::TransferFunction>(look.medium_function(place.spacing()));
  const auto visible = std::make_shared<const render::VisibleParts>(look, place);
  kinds::VolumeSight sight;
  sight.extinction = [medium](double value) { return medium->at(value).extinction; };
  sight.shows_within = [visible](double low, double high) { return visible->within(low, high); };
  for (const picture::IsoSurface& iso : look.isos) {
    if (iso.opacity * look.opacity > 0) sight.isos.push_back({iso.value, iso.opacity * look.opacity});
  }
  if (look.opacity > 0) {
    for (const picture::Slice& slice : look.slices) sight.planes.push_back(plane_of(slice, place, look.opacity));
  }
  return sight;
}

}  // namespace

std::vector<kinds::VolumeSight> volume_sights(const model::ModelFile& model, const picture::PictureRequest& request) {
  std::vector<kinds::VolumeSight> sights;
  for (const model::Volume& volume : model.volumes()) {
    render::VolumeLook look = render::look_of(request);
    if (look.points.empty()) look.points = render::preset_points(request.volumes.transfer, volume);
    sights.push_back(sight_of(look, {volume.size, volume.index_to_world}));
  }
  return sights;
}

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
