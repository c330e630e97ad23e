#include "protocol/validate.h"

#include <cmath>
#include <string>

namespace surfcast::protocol {
namespace {

tl::unexpected<Error> invalid(const char* message) {
  return fail(ErrorKind::kInvalidInput, message);
}

bool finite(const wire::Vector3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

Status check_camera(const wire::Camera& camera) {
  if (!camera.has_position() || !camera.has_focal_point()) {
    return invalid("camera: position and focal_point are both needed");
  }
  if (!finite(camera.position()) || !finite(camera.focal_point()) || !finite(camera.view_up())) {
    return invalid("camera: coordinates must be finite numbers");
  }
  if (camera.has_view_angle() && !(camera.view_angle() > 0 && camera.view_angle() < 180)) {
    return invalid("camera: view_angle must lie between 0 and 180 degrees");
  }
  return {};
}

Status check_choices(const wire::DrawPicture& picture) {
  if (!wire::FileFormat_IsValid(picture.format())) return invalid("format: unknown");
  if (!wire::Normalization_IsValid(picture.normalization())) return invalid("normalization: unknown");
  if (!wire::Filter_IsValid(picture.filter())) return invalid("filter: unknown");
  if (!wire::Shading_IsValid(picture.shading())) return invalid("shading: unknown");
  return {};
}

Status check_channels(const wire::DrawPicture& picture) {
  for (const int channel : picture.channels()) {
    if (!wire::Channel_IsValid(channel)) return invalid("channels: unknown");
  }
  if (picture.channels_size() > 0 && picture.format() != wire::FILE_FORMAT_EXR) {
    return invalid("channels: only an EXR file holds them");
  }
  return {};
}

Status check_numbers(const wire::DrawPicture& picture) {
  const wire::Resolution& resolution = picture.resolution();
  if (picture.has_resolution() && (resolution.width() == 0 || resolution.height() == 0)) {
    return invalid("resolution: must be at least 1,1");
  }
  if (!(picture.spacing() >= 0) || !std::isfinite(picture.spacing())) {
    return invalid("spacing: must be a finite number of pixels, at least 0");
  }
  const wire::Color& background = picture.background();
  if (background.red() > 255 || background.green() > 255 || background.blue() > 255) {
    return invalid("background: each part must be at most 255");
  }
  if (picture.quality() > 100) return invalid("quality: must be at most 100");
  return {};
}

Status check_coloring(const wire::Coloring& coloring) {
  if (!wire::ColorSource_IsValid(coloring.source())) return invalid("color_by: unknown");
  if (!wire::ColorMap_IsValid(coloring.map())) return invalid("color_map: unknown");
  if (!std::isfinite(coloring.first()) || !std::isfinite(coloring.last())) {
    return invalid("color_range: must be finite numbers");
  }
  if (coloring.has_first() && coloring.has_last() && !(coloring.first() < coloring.last())) {
    return invalid("color_range: the first value must be below the last");
  }
  return {};
}

Status check_clip_boxes(const wire::DrawPicture& picture) {
  if (picture.clip_boxes_size() > kMaxClipBoxes) return invalid("clip boxes: too many");
  for (const wire::ClipBox& clip : picture.clip_boxes()) {
    const wire::Vector3& low = clip.box().min();
    const wire::Vector3& high = clip.box().max();
    if (!finite(low) || !finite(high)) return invalid("clip boxes: coordinates must be finite numbers");
    if (low.x() > high.x() || low.y() > high.y() || low.z() > high.z()) {
      return invalid("clip boxes: the lower corner must come first");
    }
  }
  return {};
}

Status check_display_options(const wire::DrawPicture& picture) {
  if (Status status = check_coloring(picture.coloring()); !status) return status;
  for (const uint32_t code : picture.hidden_classes()) {
    if (code > kMaxClassCode) return invalid("hide_classes: codes must be at most 255");
  }
  if (Status status = check_clip_boxes(picture); !status) return status;
  const wire::EyeDomeLighting& eye_dome = picture.eye_dome();
  if (!(eye_dome.strength() >= 0 && eye_dome.strength() <= kMaxEyeDomeStrength)) {
    return invalid("eye_dome: the strength must lie between 0 and 100");
  }
  if (!(eye_dome.radius() >= 0 && eye_dome.radius() <= kMaxEyeDomeRadius)) {
    return invalid("eye_dome: the radius must be at most 8 pixels");
  }
  return {};
}

}  // namespace

Status check_picture(const wire::DrawPicture& picture) {
  if (picture.model().empty()) return invalid("a model must be named");
  if (picture.model().size() > kMaxModelNameBytes) return invalid("the model's name is too long");
  if (picture.has_camera()) {
    if (Status status = check_camera(picture.camera()); !status) return status;
  }
  if (Status status = check_choices(picture); !status) return status;
  if (Status status = check_channels(picture); !status) return status;
  if (Status status = check_numbers(picture); !status) return status;
  return check_display_options(picture);
}

Status check_view_picture(const wire::DrawPicture& picture) {
  if (picture.channels_size() > 0) return invalid("channels: a view has none");
  return check_picture(picture);
}

Status check_view(const wire::OpenView& view) {
  if (!(view.target_fps() >= 0 && view.target_fps() <= kMaxFramesPerSecond)) {
    return invalid("target_fps: must lie between 0 and 1000");
  }
  return check_view_picture(view.picture());
}

}  // namespace surfcast::protocol
