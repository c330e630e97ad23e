#include "protocol/validate.h"

#include <cmath>
#include <string>

namespace surfcast {
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

}  // namespace

Status check_picture(const wire::DrawPicture& picture) {
  if (picture.model().empty()) return invalid("a model must be named");
  if (picture.model().size() > kMaxModelNameBytes) return invalid("the model's name is too long");
  if (picture.has_camera()) {
    if (Status status = check_camera(picture.camera()); !status) return status;
  }
  if (Status status = check_choices(picture); !status) return status;
  return check_numbers(picture);
}

}  // namespace surfcast
