#include "protocol/validate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/invalid_input.h"
#include "protocol/parse.h"
#include "protocol/picture_fields.h"

namespace surfcast::protocol {
namespace {

bool finite(const wire::Vector3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

bool valid(const wire::Color& color) {
  return color.red() <= 255 && color.green() <= 255 && color.blue() <= 255;
}

Status check_camera(const wire::Camera& camera) {
  if (!camera.has_position() || !camera.has_focal_point()) {
    return invalid_input("camera: position and focal_point are both needed");
  }
  if (!finite(camera.position()) || !finite(camera.focal_point()) || !finite(camera.view_up())) {
    return invalid_input("camera: coordinates must be finite numbers");
  }
  if (camera.has_view_angle() && !(camera.view_angle() > 0 && camera.view_angle() < 180)) {
    return invalid_input("camera: view_angle must lie between 0 and 180 degrees");
  }
  return {};
}

Status check_channels(const wire::DrawPicture& picture) {
  for (const int channel : picture.channels()) {
    if (!wire::Channel_IsValid(channel)) return invalid_input("channels: unknown");
  }
  if (picture.channels_size() > 0 && picture.format() != wire::FILE_FORMAT_EXR) {
    return invalid_input("channels: only an EXR file holds them");
  }
  return {};
}

/// The spacing is stated, or chosen for an error or a time.
Status check_spacing(const wire::DrawPicture& picture) {
  const int stated = int{picture.spacing() > 0} + int{picture.error() > 0} + int{picture.time_ms() > 0};
  if (stated > 1) return invalid_input("spacing, error, time: at most one may be stated");
  const bool chosen = picture.error() > 0 || picture.time_ms() > 0;
  return chosen && picture.has_render_scale() ? invalid_input("render_scale: not with error or time") : Status();
}

Status check_numbers(const wire::DrawPicture& picture) {
  const wire::Resolution& resolution = picture.resolution();
  if (picture.has_resolution() && (resolution.width() == 0 || resolution.height() == 0)) {
    return invalid_input("resolution: must be at least 1,1");
  }
  if (picture.quality() > 100) return invalid_input("quality: must be at most 100");
  return check_spacing(picture);
}

Status check_coloring(const wire::Coloring& coloring) {
  if (!wire::ColorSource_IsValid(coloring.source())) return invalid_input("color_by: unknown");
  if (coloring.source() == wire::COLOR_SOURCE_ATTRIBUTE &&
      (coloring.attribute().empty() || coloring.attribute().size() > kMaxAttributeBytes)) {
    return invalid_input("color_by: an attribute must be named");
  }
  if (!std::isfinite(coloring.first()) || !std::isfinite(coloring.last())) {
    return invalid_input("color_range: must be finite numbers");
  }
  if (coloring.has_first() && coloring.has_last() && !(coloring.first() < coloring.last())) {
    return invalid_input("color_range: the first value must be below the last");
  }
  return {};
}

Status check_clip_boxes(const wire::DrawPicture& picture) {
  if (picture.clip_boxes_size() > kMaxClipBoxes) return invalid_input("clip boxes: too many");
  for (const wire::ClipBox& clip : picture.clip_boxes()) {
    const wire::Vector3& low = clip.box().min();
    const wire::Vector3& high = clip.box().max();
    if (!finite(low) || !finite(high)) return invalid_input("clip boxes: coordinates must be finite numbers");
    if (low.x() > high.x() || low.y() > high.y() || low.z() > high.z()) {
      return invalid_input("clip boxes: the lower corner must come first");
    }
  }
  return {};
}

Status check_transfer_point(const wire::TransferPoint& point) {
  const wire::Vector3& linear = point.color_linear();
  if (!std::isfinite(point.value())) return invalid_input("transfer: values must be finite numbers");
  if (!valid(point.color())) return invalid_input("transfer: each part of a colour must be at most 255");
  if (!is_share(linear.x()) || !is_share(linear.y()) || !is_share(linear.z())) {
    return invalid_input("transfer: each part of a linear colour must lie between 0 and 1");
  }
  if (!is_share(point.opacity())) return invalid_input("transfer: opacities must lie between 0 and 1");
  if (!(point.extinction() >= 0) || !std::isfinite(point.extinction())) {
    return invalid_input("transfer: extinctions must be finite numbers of at least 0");
  }
  return {};
}

Status check_transfer_points(const wire::TransferFunction& transfer) {
  if (transfer.points_size() > kMaxTransferPoints) return invalid_input("transfer: too many points");
  double before = -std::numeric_limits<double>::infinity();
  for (const wire::TransferPoint& point : transfer.points()) {
    if (Status status = check_transfer_point(point); !status) return status;
    if (point.value() < before) return invalid_input("transfer: values must ascend");
    before = point.value();
  }
  return {};
}

Status check_iso_surfaces(const wire::DrawPicture& picture) {
  if (picture.iso_surfaces_size() > kMaxIsoSurfaces) return invalid_input("iso: too many surfaces");
  for (const wire::IsoSurface& surface : picture.iso_surfaces()) {
    if (!std::isfinite(surface.value())) return invalid_input("iso: values must be finite numbers");
    if (!valid(surface.color())) return invalid_input("iso: each part of a colour must be at most 255");
    if (!is_share(surface.opacity())) return invalid_input("iso: opacities must lie between 0 and 1");
  }
  return {};
}

Status check_slices(const wire::DrawPicture& picture) {
  if (picture.slices_size() > kMaxSlices) return invalid_input("slice: too many");
  for (const wire::Slice& slice : picture.slices()) {
    if (!wire::GridAxis_IsValid(slice.axis())) return invalid_input("slice: unknown axis");
    if (slice.axis() != wire::GRID_AXIS_NONE) {
      if (!std::isfinite(slice.index())) return invalid_input("slice: the index must be a finite number");
      continue;
    }
    const wire::Vector3& n = slice.normal();
    if (!finite(slice.point()) || !finite(n)) return invalid_input("slice: coordinates must be finite numbers");
    const double length = std::hypot(n.x(), n.y(), n.z());
    if (!(length > 0) || !std::isfinite(length)) return invalid_input("slice: the normal must have a length");
  }
  return {};
}

Status check_volume_options(const wire::DrawPicture& picture) {
  const wire::TransferFunction& transfer = picture.transfer();
  if (!wire::TransferPreset_IsValid(transfer.preset())) return invalid_input("transfer: unknown preset");
  if (!std::isfinite(transfer.first()) || !std::isfinite(transfer.last())) {
    return invalid_input("transfer: the first and last value must be finite numbers");
  }
  if (transfer.has_first() && transfer.has_last() && !(transfer.first() < transfer.last())) {
    return invalid_input("transfer: the first value must be below the last");
  }
  if (Status status = check_iso_surfaces(picture); !status) return status;
  if (Status status = check_slices(picture); !status) return status;
  return check_transfer_points(transfer);
}

bool names_attribute(const std::string& name) {
  return !name.empty() && name.size() <= kMaxAttributeBytes;
}

Status check_glyphs(const wire::Glyphs& glyphs) {
  if (!wire::GlyphShape_IsValid(glyphs.shape())) return invalid_input("glyph: unknown shape");
  if (glyphs.has_sharpness() && !(glyphs.sharpness() >= 0 && glyphs.sharpness() <= kMaxSharpness)) {
    return invalid_input("glyph: the sharpness must lie between 0 and 10");
  }
  if (glyphs.thresholds_size() > kMaxThresholds) return invalid_input("threshold: too many");
  for (const wire::Threshold& threshold : glyphs.thresholds()) {
    if (!names_attribute(threshold.attribute())) return invalid_input("threshold: an attribute must be named");
    if (!std::isfinite(threshold.smallest()) || !std::isfinite(threshold.largest())) {
      return invalid_input("threshold: must be finite numbers");
    }
    if (threshold.has_largest() && threshold.largest() < threshold.smallest()) {
      return invalid_input("threshold: the smallest value must come first");
    }
  }
  return {};
}

Status check_lighting(const wire::Lighting& lighting) {
  const auto positive = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!positive(lighting.ambient()) || !positive(lighting.specular()) || !positive(lighting.exponent())) {
    return invalid_input("lights: ambient, specular and exponent must be finite and at least 0");
  }
  if (lighting.lights_size() > kMaxLights) return invalid_input("lights: too many");
  for (const wire::Light& light : lighting.lights()) {
    const wire::Vector3& l = light.direction();
    const double length = std::hypot(l.x(), l.y(), l.z());
    if (!finite(l) || !(length > 0) || !std::isfinite(length))
      return invalid_input("lights: a direction must have a length");
    if (!positive(light.power())) return invalid_input("lights: powers must be finite and at least 0");
  }
  return {};
}

/// How surfels of single classes are seen through.
Status check_class_opacities(const wire::DrawPicture& picture) {
  if (picture.class_opacities_size() > static_cast<int>(kMaxClassCode) + 1) {
    return invalid_input("opacity_by_class: too many classes");
  }
  for (const wire::ClassOpacity& of : picture.class_opacities()) {
    if (of.code() > kMaxClassCode) return invalid_input("opacity_by_class: codes must be at most 255");
    if (!is_share(of.opacity())) return invalid_input("opacity_by_class: factors must lie between 0 and 1");
  }
  return {};
}

Status check_hidden_models(const wire::DrawPicture& picture) {
  if (picture.hidden_models().size() > static_cast<int>(kMaxJoinedModels))
    return invalid_input("hide_models: too many models");
  for (const std::string& name : picture.hidden_models()) {
    if (name.empty() || name.size() > kMaxModelNameBytes) return invalid_input("hide_models: names of 1 to 512 bytes");
  }
  return {};
}

Status check_display_options(const wire::DrawPicture& picture) {
  if (Status status = check_coloring(picture.coloring()); !status) return status;
  for (const uint32_t code : picture.hidden_classes()) {
    if (code > kMaxClassCode) return invalid_input("hide_classes: codes must be at most 255");
  }
  if (Status status = check_clip_boxes(picture); !status) return status;
  if (Status status = check_class_opacities(picture); !status) return status;
  if (Status status = check_hidden_models(picture); !status) return status;
  const wire::EyeDomeLighting& eye_dome = picture.eye_dome();
  if (!(eye_dome.strength() >= 0 && eye_dome.strength() <= kMaxEyeDomeStrength)) {
    return invalid_input("eye_dome: the strength must lie between 0 and 100");
  }
  if (!(eye_dome.radius() >= 0 && eye_dome.radius() <= kMaxEyeDomeRadius)) {
    return invalid_input("eye_dome: the radius must be at most 8 pixels");
  }
  if (Status status = check_glyphs(picture.glyphs()); !status) return status;
  if (Status status = check_lighting(picture.lighting()); !status) return status;
  return check_volume_options(picture);
}

}  // namespace

Status check_model_name(const std::string& name) {
  if (name.empty()) return invalid_input("a model must be named");
  size_t models = 0;
  for (std::string_view rest = name;; ++models) {
    const size_t end = std::min(rest.find('+'), rest.size());
    if (end > kMaxModelNameBytes) return invalid_input("the model's name is too long");
    if (end == rest.size()) break;
    rest.remove_prefix(end + 1);
  }
  if (models >= kMaxJoinedModels) return invalid_input("the name joins more than 64 models");
  return {};
}

Status check_picture(const wire::DrawPicture& picture) {
  if (Status status = check_model_name(picture.model()); !status) return status;
  if (picture.has_camera()) {
    if (Status status = check_camera(picture.camera()); !status) return status;
  }
  if (!wire::FileFormat_IsValid(picture.format())) return invalid_input("format: unknown");
  if (Status status = check_plain_fields(picture); !status) return status;
  if (Status status = check_channels(picture); !status) return status;
  if (Status status = check_numbers(picture); !status) return status;
  return check_display_options(picture);
}

Status check_view_picture(const wire::DrawPicture& picture) {
  if (picture.channels_size() > 0) return invalid_input("channels: a view has none");
  return check_picture(picture);
}

Status check_view(const wire::OpenView& view) {
  if (!(view.target_fps() >= 0 && view.target_fps() <= kMaxFramesPerSecond)) {
    return invalid_input("target_fps: must lie between 0 and 1000");
  }
  return check_view_picture(view.picture());
}

}  // namespace surfcast::protocol
