#include "net/convert.h"

#include <cmath>
#include <limits>
#include <utility>

#include "model/volume_facts.h"
#include "protocol/errors.h"
#include "protocol/picture_fields.h"
#include "protocol/profile_query.h"
#include "protocol/validate.h"

namespace surfcast::net {
namespace {

glm::dvec3 from_wire(const wire::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

void to_wire(const glm::dvec3& v, wire::Vector3* message) {
  message->set_x(v.x);
  message->set_y(v.y);
  message->set_z(v.z);
}

/// Resolutions beyond int are refused later like any that is too large.
int clamp_to_int(uint32_t value) {
  constexpr uint32_t kLargest = std::numeric_limits<int>::max();
  return static_cast<int>(value < kLargest ? value : kLargest);
}

picture::Normalization from_wire(wire::Normalization value) {
  return value == wire::NORMALIZATION_SURFEL ? picture::Normalization::kSurfel : picture::Normalization::kPixel;
}

picture::Filter from_wire(wire::Filter value) {
  return value == wire::FILTER_NONE ? picture::Filter::kNone : picture::Filter::kEwa;
}

picture::Shading from_wire(wire::Shading value) {
  if (value == wire::SHADING_UNLIT) return picture::Shading::kUnlit;
  return value == wire::SHADING_LIT ? picture::Shading::kLit : picture::Shading::kAuto;
}

picture::SplatConvention from_wire(wire::SplatConvention value) {
  return value == wire::SPLAT_CONVENTION_EXACT ? picture::SplatConvention::kExact : picture::SplatConvention::kTrained;
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

wire::FileFormat to_wire(picture::FileFormat value) {
  switch (value) {
    case picture::FileFormat::kJpeg:
      return wire::FILE_FORMAT_JPEG;
    case picture::FileFormat::kWebp:
      return wire::FILE_FORMAT_WEBP;
    case picture::FileFormat::kExr:
      return wire::FILE_FORMAT_EXR;
    case picture::FileFormat::kPng:
      break;
  }
  return wire::FILE_FORMAT_PNG;
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
    default:
      return picture::TransferPreset::kGray;
  }
}

glm::u8vec3 from_wire(const wire::Color& color) {
  return {color.red(), color.green(), color.blue()};
}

picture::Transfer from_wire(const wire::TransferFunction& transfer) {
  picture::Transfer result;
  result.preset = from_wire(transfer.preset());
  if (transfer.has_first()) result.first = transfer.first();
  if (transfer.has_last()) result.last = transfer.last();
  for (const wire::TransferPoint& point : transfer.points()) {
    result.points.push_back({point.value(), glm::dvec3(from_wire(point.color())) / 255.0, point.opacity()});
  }
  return result;
}

/// What is shown of the model, and in which colours.
void set_display_options(const wire::DrawPicture& request, picture::PictureRequest& picture) {
  picture.coloring = from_wire(request.coloring());
  for (const uint32_t code : request.hidden_classes()) picture.hidden_classes.set(code);
  for (const wire::ClipBox& clip : request.clip_boxes()) {
    const geometry::Box box{from_wire(clip.box().min()), from_wire(clip.box().max())};
    (clip.inverted() ? picture.clip.outside : picture.clip.inside).push_back(box);
  }
  picture.eye_dome.strength = request.eye_dome().strength();
  const double radius = request.eye_dome().radius();
  picture.eye_dome.radius = radius > 0 ? radius : protocol::kDefaultEyeDomeRadius;
  picture.volumes = {from_wire(request.transfer()), request.shaded()};
}

geometry::Camera from_wire(const wire::Camera& camera) {
  return {.position = from_wire(camera.position()),
          .focal_point = from_wire(camera.focal_point()),
          .view_up = from_wire(camera.view_up()),
          .view_angle = camera.has_view_angle() ? camera.view_angle() : protocol::kDefaultViewAngle};
}

void to_wire(const geometry::Camera& camera, wire::Camera* message) {
  to_wire(camera.position, message->mutable_position());
  to_wire(camera.focal_point, message->mutable_focal_point());
  to_wire(camera.view_up, message->mutable_view_up());
  message->set_view_angle(camera.view_angle);
}

}  // namespace

Result<service::PictureJob> to_job(const wire::DrawPicture& request) {
  if (Status status = protocol::check_picture(request); !status) return fail(status.error());
  const wire::Resolution& resolution = request.resolution();
  service::PictureJob job;
  job.model = request.model();
  if (request.has_camera()) job.request.camera = from_wire(request.camera());
  job.up_from_model = request.has_camera() && !request.camera().has_view_up();
  job.request.width = clamp_to_int(request.has_resolution() ? resolution.width() : protocol::kDefaultWidth);
  job.request.height = clamp_to_int(request.has_resolution() ? resolution.height() : protocol::kDefaultHeight);
  job.request.normalization = from_wire(request.normalization());
  job.request.filter = from_wire(request.filter());
  job.request.shading = from_wire(request.shading());
  job.request.splat_convention = from_wire(request.splat_convention());
  job.request.silhouettes = true;
  job.request.spacing = request.spacing();
  job.request.background = from_wire(request.background());
  set_display_options(request, job.request);
  job.format = from_wire(request.format());
  for (const int channel : request.channels()) job.channels.set(static_cast<size_t>(channel));
  job.quality = static_cast<int>(request.quality() == 0 ? protocol::kDefaultQuality : request.quality());
  return job;
}

Result<service::PickJob> to_job(const wire::PickSurfel& request) {
  Result<service::PictureJob> picture = to_job(request.picture());
  if (!picture) return fail(picture.error());
  return service::PickJob{std::move(picture->model), std::move(picture->request), picture->up_from_model,
                          clamp_to_int(request.x()), clamp_to_int(request.y())};
}

Result<service::ProfileJob> to_job(const wire::GetProfile& request) {
  if (Status status = protocol::check_profile(request); !status) return fail(std::move(status.error()));
  service::ProfileJob job;
  job.model = request.model();
  for (const wire::Vector3& point : request.line()) job.query.line.push_back(from_wire(point));
  job.query.width = request.width();
  job.query.most = request.max_points();
  return job;
}

void to_wire(const service::ProfileResult& result, wire::Profile& message) {
  const pick::Band& band = result.band;
  message.set_total(band.total);
  message.set_length(band.length);
  message.set_z_up(result.z_up);
  to_wire(band.grid.scale, message.mutable_scale());
  to_wire(band.grid.offset, message.mutable_offset());
  message.set_color_bits(static_cast<uint32_t>(result.color_bits));
  for (const pick::BandPoint& point : band.points) {
    message.add_x(point.position.x);
    message.add_y(point.position.y);
    message.add_z(point.position.z);
    message.add_along(point.place.along);
    message.add_across(point.place.across);
    if (result.color_bits == 0) continue;
    message.add_red(point.color.r);
    message.add_green(point.color.g);
    message.add_blue(point.color.b);
  }
  for (size_t a = 0; a < result.attributes.size(); ++a) {
    wire::AttributeColumn* column = message.add_attributes();
    column->set_attribute(protocol::clean_utf8(result.attributes[a]));
    for (size_t i = a; i < band.values.size(); i += result.attributes.size()) column->add_values(band.values[i]);
  }
}

void to_wire(const std::optional<kinds::PickedSurfel>& picked, wire::PickResult& message) {
  message.set_hit(picked.has_value());
  if (!picked) return;
  to_wire(picked->position, message.mutable_position());
  to_wire(picked->normal, message.mutable_normal());
  if (picked->color) {
    message.mutable_color()->set_red(picked->color->r);
    message.mutable_color()->set_green(picked->color->g);
    message.mutable_color()->set_blue(picked->color->b);
  }
  message.set_radius(picked->radius);
  message.set_distance(picked->distance);
  message.set_depth(picked->depth);
  message.set_surfel(picked->number);
  for (const kinds::PickedValue& value : picked->values) {
    wire::AttributeValue* attribute = message.add_attributes();
    attribute->set_attribute(protocol::clean_utf8(value.attribute));
    attribute->set_value(value.value);
  }
}

void to_wire(service::EncodedPicture picture, wire::Picture& message) {
  message.set_data(picture.bytes.data(), picture.bytes.size());
  message.set_format(to_wire(picture.format));
  to_wire(picture.camera, message.mutable_camera());
  message.mutable_resolution()->set_width(static_cast<uint32_t>(picture.width));
  message.mutable_resolution()->set_height(static_cast<uint32_t>(picture.height));
  message.set_normalization(picture.normalization == picture::Normalization::kSurfel ? wire::NORMALIZATION_SURFEL
                                                                                     : wire::NORMALIZATION_PIXEL);
  message.set_spacing(picture.spacing);
  message.set_converged(picture.converged && !picture.preview);
  message.set_preview(picture.preview);
  message.set_surfels_drawn(picture.stats.surfels_drawn);
  message.set_blocks_drawn(picture.stats.blocks_drawn);
  message.set_blocks_selected(picture.stats.blocks_selected);
  message.set_blocks_waited_for(picture.stats.blocks_waited_for);
  message.set_blocks_resident(picture.stats.blocks_resident);
  message.set_bytes_resident(picture.stats.bytes_resident);
  for (const picture::LevelStats& stats : picture.stats.levels) {
    wire::Level* level = message.add_levels();
    level->set_level(static_cast<uint32_t>(stats.level));
    level->set_blocks_selected(stats.selected);
    level->set_blocks_drawn(stats.drawn);
  }
  message.set_gl_renderer(protocol::clean_utf8(picture.stats.gl_renderer));
  for (const picture::StageTime& time : picture.stats.stages) {
    wire::Stage* stage = message.add_stages();
    stage->set_name(protocol::clean_utf8(time.name));
    stage->set_milliseconds(time.milliseconds);
  }
}

void to_wire(view::ViewMessage message, wire::ViewFrame& frame) {
  frame.set_frame(message.frame);
  frame.set_more(message.more);
  if (!message.first) {
    const std::vector<std::byte>& piece = message.picture.bytes;
    frame.mutable_picture()->set_data(piece.data(), piece.size());
    return;
  }
  frame.set_update(message.update);
  frame.mutable_resolution()->set_width(static_cast<uint32_t>(message.width));
  frame.mutable_resolution()->set_height(static_cast<uint32_t>(message.height));
  frame.set_moving(message.moving);
  to_wire(std::move(message.picture), *frame.mutable_picture());
}

namespace {

wire::ScanState to_wire(service::ScanStatus::State state) {
  switch (state) {
    case service::ScanStatus::State::kWaiting:
      return wire::SCAN_STATE_WAITING;
    case service::ScanStatus::State::kBuilding:
      return wire::SCAN_STATE_BUILDING;
    case service::ScanStatus::State::kFailed:
      break;
  }
  return wire::SCAN_STATE_FAILED;
}

}  // namespace

void to_wire(const service::ModelList& list, const UploadConfig& uploads, wire::ModelList& message) {
  for (const std::string& name : list.names) message.add_models(protocol::clean_utf8(name));
  for (const service::ScanStatus& scan : list.scans) {
    wire::ScanStatus* to = message.add_scans();
    to->set_model(protocol::clean_utf8(scan.model));
    to->set_state(to_wire(scan.state));
    to->set_done(scan.done);
    to->set_seconds_left(scan.seconds_left);
    to->set_problem(protocol::clean_utf8(scan.problem));
    to->set_edition(scan.edition);
  }
  if (uploads.folder.empty()) return;
  message.mutable_uploads()->set_max_bytes(uploads.bytes);
  for (const std::string& extension : uploads.extensions) message.mutable_uploads()->add_extensions(extension);
}

void to_wire(const picture::TransferPoint& point, wire::TransferPoint& message) {
  const auto code = [](double part) { return static_cast<uint32_t>(std::lround(255 * part)); };
  message.set_value(point.value);
  message.mutable_color()->set_red(code(point.color.r));
  message.mutable_color()->set_green(code(point.color.g));
  message.mutable_color()->set_blue(code(point.color.b));
  message.set_opacity(point.opacity);
}

void to_wire(const model::Volume& volume, const service::VolumePresets& presets, wire::VolumeDescription& message) {
  const glm::dvec3 spacing = spacing_of(volume);
  for (int axis = 0; axis < 3; ++axis) {
    message.add_size(volume.size[axis]);
    message.add_spacing(spacing[axis]);
  }
  message.set_name(protocol::clean_utf8(volume.name));
  message.set_low(volume.low);
  message.set_high(volume.high);
  message.mutable_histogram()->Assign(volume.histogram.begin(), volume.histogram.end());
  message.set_length_unit(protocol::clean_utf8(volume.length_unit));
  message.set_sample_unit(protocol::clean_utf8(volume.sample_unit));
  for (size_t i = 0; i < presets.size(); ++i) {
    wire::PresetPoints& preset = *message.add_presets();
    preset.set_preset(static_cast<wire::TransferPreset>(i));
    for (const picture::TransferPoint& point : presets[i]) to_wire(point, *preset.add_points());
  }
}

void to_wire(const std::string& name, const service::ModelDescription& description, wire::ModelDescription& message) {
  const model::ModelInfo& info = description.info;
  message.set_model(name);
  message.set_surfels(info.surfels);
  to_wire(info.bounds.min, message.mutable_bounds()->mutable_min());
  to_wire(info.bounds.max, message.mutable_bounds()->mutable_max());
  message.set_oriented(info.oriented);
  message.set_z_up(info.z_up);
  message.set_color_bits(static_cast<uint32_t>(info.color_bits));
  for (const std::string& attribute : info.scalar_names) message.add_attributes(protocol::clean_utf8(attribute));
  for (const std::string& source : info.source_names) message.add_sources(protocol::clean_utf8(source));
  message.set_levels(description.levels);
  message.set_blocks(description.blocks);
  message.set_spacing(description.spacing);
  message.set_upside_down(info.upside_down);
  for (const model::KindCount& kind : info.kinds) {
    wire::KindCount* to = message.add_kinds();
    to->set_kind(protocol::clean_utf8(kind.kind));
    to->set_items(kind.items);
  }
  for (size_t i = 0; i < description.volumes.size(); ++i) {
    to_wire(description.volumes[i], description.presets[i], *message.add_volumes());
  }
  for (const model::AttributeRange& range : info.ranges) {
    wire::AttributeRange* to = message.add_ranges();
    to->set_attribute(protocol::clean_utf8(range.attribute));
    to->set_smallest(range.smallest);
    to->set_largest(range.largest);
    to->set_low(range.low);
    to->set_high(range.high);
  }
  for (const model::ClassCount& count : info.classes) {
    wire::ClassCount* to = message.add_classes();
    to->set_code(count.code);
    to->set_surfels(count.surfels);
  }
}

std::string media_type(picture::FileFormat format) {
  return std::string(protocol::media_type(to_wire(format)));
}

}  // namespace surfcast::net
