#include "colorize/photo_camera.h"

#include <cmath>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "base/json_text.h"
#include "mesh/model_files.h"

namespace surfcast::colorize {
namespace {

using Json = nlohmann::json;

/// `count` finite numbers; none if the member is anything else.
std::optional<std::vector<double>> numbers_of(const Json& json, const char* name, size_t count) {
  const auto at = json.find(name);
  if (at == json.end() || !at->is_array() || at->size() != count) return std::nullopt;
  std::vector<double> numbers;
  for (const Json& one : *at) {
    if (!one.is_number() || !std::isfinite(one.get<double>())) return std::nullopt;
    numbers.push_back(one.get<double>());
  }
  return numbers;
}

bool is_rotation(const glm::dmat3& matrix) {
  constexpr double kMaxError = 1e-3;
  const glm::dmat3 product = matrix * glm::transpose(matrix);
  double error = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) error = std::max(error, std::abs(product[i][j] - (i == j ? 1 : 0)));
  }
  return error < kMaxError && glm::determinant(matrix) > 0;
}

/// None if something is missing or makes no sense.
std::optional<PhotoCamera> camera_of(const Json& json, const std::filesystem::path& path) {
  if (!json.is_object()) return std::nullopt;
  const auto image = json.find("image");
  const auto position = numbers_of(json, "position", 3);
  const auto rotation = numbers_of(json, "rotation", 9);
  const auto focal = numbers_of(json, "focal", 2);
  const auto principal = numbers_of(json, "principal_point", 2);
  if (image == json.end() || !image->is_string() || !position || !rotation || !focal || !principal) return std::nullopt;
  const auto file = mesh::named_file(path, image->get<std::string>());
  const std::vector<double>& r = *rotation;
  PhotoCamera camera;
  camera.to_camera = glm::dmat3(r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]);
  if (!file || !is_rotation(camera.to_camera) || (*focal)[0] <= 0 || (*focal)[1] <= 0) return std::nullopt;
  camera.image = *file;
  camera.position = {(*position)[0], (*position)[1], (*position)[2]};
  camera.focal = {(*focal)[0], (*focal)[1]};
  camera.principal = {(*principal)[0], (*principal)[1]};
  if (const auto k = numbers_of(json, "radial", 3)) camera.radial = {(*k)[0], (*k)[1], (*k)[2]};
  if (const auto p = numbers_of(json, "tangential", 2)) camera.tangential = {(*p)[0], (*p)[1]};
  return camera;
}

}  // namespace

std::optional<PhotoCamera::Seen> PhotoCamera::project(const glm::dvec3& world) const {
  const glm::dvec3 local = to_camera * (world - position);
  if (!(local.z > 0)) return std::nullopt;
  const double x = local.x / local.z;
  const double y = local.y / local.z;
  const double r2 = x * x + y * y;
  const double factor = 1 + r2 * (radial[0] + r2 * (radial[1] + r2 * radial[2]));
  const glm::dvec2 moved(x * factor + 2 * tangential[0] * x * y + tangential[1] * (r2 + 2 * x * x),
                         y * factor + tangential[0] * (r2 + 2 * y * y) + 2 * tangential[1] * x * y);
  return Seen{focal * moved + principal, local};
}

Result<std::vector<PhotoCamera>> parse_cameras(std::string_view text, const std::filesystem::path& path) {
  const Json json = parse_json_text(text);
  const auto named = [&path](const std::string& what) {
    return fail(ErrorKind::kInvalidInput, path.string() + ": " + what);
  };
  if (!json.is_object() || !json.contains("cameras") || !json["cameras"].is_array()) {
    return named("is no JSON with a list of cameras");
  }
  std::vector<PhotoCamera> cameras;
  for (const Json& one : json["cameras"]) {
    std::optional<PhotoCamera> camera = camera_of(one, path);
    if (!camera) {
      return named("camera " + std::to_string(cameras.size()) +
                   " lacks an image in the folder, a position, a rotation, a focal length or a principal point");
    }
    cameras.push_back(std::move(*camera));
  }
  if (cameras.empty()) return named("has no cameras");
  return cameras;
}

}  // namespace surfcast::colorize
