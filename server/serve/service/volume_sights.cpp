#include "service/volume_sights.h"

#include <glm/geometric.hpp>
#include <memory>

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

}  // namespace surfcast::service
