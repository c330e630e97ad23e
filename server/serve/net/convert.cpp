#include "net/convert.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "protocol/picture_fields.h"
#include "protocol/points_query.h"
#include "protocol/profile_query.h"
#include "protocol/validate.h"
#include "surfel/srgb.h"

namespace surfcast::net {
namespace {

glm::dvec3 from_wire(const wire::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Resolutions beyond int are refused later like any that is too large.
int clamp_to_int(uint32_t value) {
  constexpr uint32_t kLargest = std::numeric_limits<int>::max();
  return static_cast<int>(value < kLargest ? value : kLargest);
}

geometry::Corridor from_wire(const wire::Corridor& corridor) {
  geometry::Corridor result;
  for (int i = 0; i + 1 < corridor.line_size(); i += 2)
    result.line.emplace_back(corridor.line(i), corridor.line(i + 1));
  result.half_width = corridor.width() / 2;
  if (corridor.has_low()) result.low = corridor.low();
  if (corridor.has_high()) result.high = corridor.high();
  return result;
}

picture::FileFormat from_wire(wire::FileFormat value) {
  switch (value) {
    case wire::FILE_FORMAT_JPEG:
      return picture::FileFormat::kJpeg;
    case wire::FILE_FORMAT_WEBP:
      return picture::FileFormat::kWebp;
    case wire::FILE_FORMAT_EXR:
      return picture::FileFormat::kExr;
    default:
      return picture::FileFormat::kPng;
  }
}

picture::SurfelColor from_wire(wire::ColorSource source) {
  switch (source) {
    case wire::COLOR_SOURCE_INTENSITY:
      return picture::SurfelColor::kIntensity;
    case wire::COLOR_SOURCE_ELEVATION:
      return picture::SurfelColor::kElevation;
    case wire::COLOR_SOURCE_CLASSIFICATION:
      return picture::SurfelColor::kClassification;
    case wire::COLOR_SOURCE_NORMAL:
      return picture::SurfelColor::kNormal;
    case wire::COLOR_SOURCE_DIRECTION:
      return picture::SurfelColor::kDirection;
    case wire::COLOR_SOURCE_DEC:
      return picture::SurfelColor::kDec;
    case wire::COLOR_SOURCE_ATTRIBUTE:
      return picture::SurfelColor::kAttribute;
    default:
      return picture::SurfelColor::kStored;
  }
}

picture::ColorMap from_wire(wire::ColorMap map) {
  switch (map) {
    case wire::COLOR_MAP_TURBO:
      return picture::ColorMap::kTurbo;
    case wire::COLOR_MAP_GRAY:
      return picture::ColorMap::kGray;
    case wire::COLOR_MAP_TERRAIN:
      return picture::ColorMap::kTerrain;
    default:
      return picture::ColorMap::kViridis;
  }
}

picture::Coloring from_wire(const wire::Coloring& coloring) {
  picture::Coloring result{from_wire(coloring.source()), from_wire(coloring.map())};
  if (coloring.has_first()) result.first = coloring.first();
  if (coloring.has_last()) result.last = coloring.last();
  result.attribute = coloring.attribute();
  return result;
}

picture::GlyphRadius from_wire(wire::GlyphRadius radius) {
  if (radius == wire::GLYPH_RADIUS_ROOT) return picture::GlyphRadius::kRoot;
  return radius == wire::GLYPH_RADIUS_UNIT ? picture::GlyphRadius::kUnit : picture::GlyphRadius::kEigenvalue;
}

picture::GlyphOptions from_wire(const wire::Glyphs& glyphs) {
  picture::GlyphOptions result;
  if (glyphs.shape() == wire::GLYPH_SHAPE_SUPERQUADRIC) result.shape = picture::GlyphShape::kSuperquadric;
  result.radius = from_wire(glyphs.radius());
  if (glyphs.has_scale()) result.scale = glyphs.scale();
  if (glyphs.has_sharpness()) result.sharpness = glyphs.sharpness();
  for (const wire::Threshold& threshold : glyphs.thresholds()) {
    result.thresholds.push_back({threshold.attribute(), threshold.smallest()});
    if (threshold.has_largest()) result.thresholds.back().largest = threshold.largest();
  }
  return result;
}

picture::Lighting from_wire(const wire::Lighting& lighting) {
  picture::Lighting result{lighting.ambient(), lighting.specular(), lighting.exponent()};
  for (const wire::Light& light : lighting.lights()) {
    result.lights.push_back({from_wire(light.direction()), light.power()});
  }
  return result;
}

picture::TransferPreset from_wire(wire::TransferPreset preset) {
  switch (preset) {
    case wire::TRANSFER_PRESET_CT_BONE:
      return picture::TransferPreset::kCtBone;
    case wire::TRANSFER_PRESET_CT_SOFT:
      return picture::TransferPreset::kCtSoft;
    case wire::TRANSFER_PRESET_MR:
      return picture::TransferPreset::kMr;
    case wire::TRANSFER_PRESET_AUTO:
      return picture::TransferPreset::kAuto;
    default:
      return picture::TransferPreset::kGray;
  }
}

glm::u8vec3 from_wire(const wire::Color& color) {
  return {color.red(), color.green(), color.blue()};
}

glm::dvec3 srgb_from_linear(const wire::Vector3& light) {
  return {surfel::encode_srgb(light.x()), surfel::encode_srgb(light.y()), surfel::encode_srgb(light.z())};
}

picture::TransferPoint from_wire(const wire::TransferPoint& point) {
  picture::TransferPoint result{point.value(), glm::dvec3(from_wire(point.color())) / 255.0, point.opacity()};
  if (point.has_color_linear()) result.color = srgb_from_linear(point.color_linear());
  if (point.has_extinction()) result.extinction = point.extinction();
  return result;
}

picture::Transfer from_wire(const wire::TransferFunction& transfer) {
  picture::Transfer result;
  result.preset = from_wire(transfer.preset());
  if (transfer.has_first()) result.first = transfer.first();
  if (transfer.has_last()) result.last = transfer.last();
  result.points.reserve(static_cast<size_t>(transfer.points_size()));
  for (const wire::TransferPoint& point : transfer.points()) result.points.push_back(from_wire(point));
  return result;
}

picture::IsoSurface from_wire(const wire::IsoSurface& surface) {
  picture::IsoSurface result{surface.value()};
  if (surface.has_color()) result.color = glm::dvec3(from_wire(surface.color())) / 255.0;
  if (surface.has_opacity()) result.opacity = surface.opacity();
  return result;
}

picture::Slice from_wire(const wire::Slice& slice) {
  picture::Slice result{from_wire(slice.point()), from_wire(slice.normal())};
  if (slice.axis() != wire::GRID_AXIS_NONE) result.axis = slice.axis() - wire::GRID_AXIS_I;
  result.index = slice.index();
  return result;
}

picture::VolumeOptions volume_options(const wire::DrawPicture& request) {
  picture::VolumeOptions options{from_wire(request.transfer())};
  if (!request.has_transfer()) options.transfer.preset = picture::TransferPreset::kAuto;
  const bool automatic = options.transfer.preset == picture::TransferPreset::kAuto && options.transfer.points.empty();
  options.shaded = request.has_shaded() ? request.shaded() : automatic && request.shading() != wire::SHADING_UNLIT;
  for (const wire::IsoSurface& surface : request.iso_surfaces()) options.isos.push_back(from_wire(surface));
  for (const wire::Slice& slice : request.slices()) options.slices.push_back(from_wire(slice));
  const bool surfaces = !options.isos.empty() || !options.slices.empty();
  options.medium = request.has_medium() ? request.medium() : !surfaces || request.has_transfer();
  return options;
}

/// The options with a structure: what is shown of the model, and in which colours.
void set_display_options(const wire::DrawPicture& request, picture::PictureRequest& picture) {
  picture.coloring = from_wire(request.coloring());
  for (const uint32_t code : request.hidden_classes()) picture.hidden_classes.set(code);
  picture.hidden_models.assign(request.hidden_models().begin(), request.hidden_models().end());
  for (const wire::ClipBox& clip : request.clip_boxes()) {
    const geometry::Box box{from_wire(clip.box().min()), from_wire(clip.box().max())};
    (clip.inverted() ? picture.clip.outside : picture.clip.inside).push_back(box);
  }
  picture.eye_dome.strength = request.eye_dome().strength();
  const double radius = request.eye_dome().radius();
  picture.eye_dome.radius = radius > 0 ? radius : protocol::kDefaultEyeDomeRadius;
  picture.volumes = volume_options(request);
  picture.glyphs = from_wire(request.glyphs());
  picture.lighting = from_wire(request.lighting());
  for (const wire::ClassOpacity& of : request.class_opacities()) {
    picture.class_opacities.push_back({static_cast<uint8_t>(of.code()), of.opacity()});
  }
}

geometry::Camera from_wire(const wire::Camera& camera) {
  return {.position = from_wire(camera.position()),
          .focal_point = from_wire(camera.focal_point()),
          .view_up = from_wire(camera.view_up()),
          .view_angle = camera.has_view_angle() ? camera.view_angle() : protocol::kDefaultViewAngle};
}

}  // namespace

Result<service::PictureJob> to_job(const wire::DrawPicture& request, const access::AuthorizedModel& model) {
  if (Status status = protocol::check_picture(request); !status) return fail(status);
  const wire::Resolution& resolution = request.resolution();
  service::PictureJob job{model};
  static_cast<picture::PlainOptions&>(job.request) = protocol::plain_options(request);
  if (request.has_camera()) job.request.camera = from_wire(request.camera());
  job.up_from_model = request.has_camera() && !request.camera().has_view_up();
  job.request.width = clamp_to_int(request.has_resolution() ? resolution.width() : protocol::kDefaultWidth);
  job.request.height = clamp_to_int(request.has_resolution() ? resolution.height() : protocol::kDefaultHeight);
  job.request.silhouettes = true;
  set_display_options(request, job.request);
  job.format = from_wire(request.format());
  for (const int channel : request.channels()) job.channels.set(static_cast<size_t>(channel));
  job.quality = static_cast<int>(request.quality() == 0 ? protocol::kDefaultQuality : request.quality());
  return job;
}

Result<service::PickJob> to_job(const wire::PickSurfel& request, const access::AuthorizedModel& model) {
  Result<service::PictureJob> picture = to_job(request.picture(), model);
  if (!picture) return fail(picture);
  return service::PickJob{std::move(picture->model), std::move(picture->request), picture->up_from_model,
                          clamp_to_int(request.x()), clamp_to_int(request.y())};
}

Result<service::ProfileJob> to_job(const wire::GetProfile& request, const access::AuthorizedModel& model) {
  if (Status status = protocol::check_profile(request); !status) return fail(status);
  service::ProfileJob job{model};
  for (const wire::Vector3& point : request.line()) job.query.line.push_back(from_wire(point));
  job.query.width = request.width();
  job.query.most = request.max_points();
  return job;
}

Result<service::PointsJob> to_job(const wire::GetPoints& request, const access::AuthorizedModel& model) {
  if (Status status = protocol::check_points(request); !status) return fail(status);
  service::PointsJob job{model};
  service::PointsQuery& query = job.query;
  scan::Selection& points = query.selection.points;
  for (const wire::Box& box : request.boxes())
    points.zone.boxes.push_back({from_wire(box.min()), from_wire(box.max())});
  for (const wire::Corridor& corridor : request.corridors()) points.zone.corridors.push_back(from_wire(corridor));
  points.classes.assign(request.classes().begin(), request.classes().end());
  points.every = std::max<uint64_t>(request.every(), 1);
  query.selection.source_coordinates = !request.world_coordinates();
  query.selection.normals = request.normals();
  query.format = *exporter::point_format_of(protocol::name_of(request.format()));
  query.most = request.max_points();
  query.only_count = request.only_count();
  return job;
}

}  // namespace surfcast::net
