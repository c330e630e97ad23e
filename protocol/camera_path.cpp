#include "protocol/camera_path.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/invalid_input.h"
#include "base/json_text.h"
#include "base/mapped_file.h"
#include "protocol/picture_fields.h"
#include "protocol/request_flags.h"
#include "protocol/validate.h"

namespace surfcast::protocol {
namespace {

using nlohmann::json;
using Vector = std::array<double, 3>;

Vector from_wire(const wire::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

void to_wire(const Vector& v, wire::Vector3* message) {
  message->set_x(v[0]);
  message->set_y(v[1]);
  message->set_z(v[2]);
}

Vector scaled_sum(double a, const Vector& u, double b, const Vector& v) {
  return {a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2]};
}

double dot(const Vector& u, const Vector& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

double length(const Vector& v) {
  return std::sqrt(dot(v, v));
}

Vector unit(const Vector& v) {
  const double size = length(v);
  return size > 0 ? scaled_sum(1 / size, v, 0, v) : v;
}

/// Velocity at the middle of three values: the slope of the parabola through them, at most three times the lower of the
/// mean speeds of the two segments. `before` and `after` are the mean velocities of these segments.
Vector velocity(const Vector& before, double time_before, const Vector& after, double time_after) {
  const double share = time_before / (time_before + time_after);
  const Vector mean = scaled_sum(1 - share, before, share, after);
  const double most = 3 * std::min(length(before), length(after));
  const double size = length(mean);
  return size > most ? scaled_sum(most / size, mean, 0, mean) : mean;
}

/// A value of the keyframes at `time`, on the cubic between keyframes `first` and `first` + 1.
template <typename Value>
Vector interpolate(const std::vector<Keyframe>& keys, size_t first, double time, const Value& value) {
  const auto step = [&](size_t i) { return keys[i + 1].time - keys[i].time; };
  const auto slope = [&](size_t i) {
    return scaled_sum(1 / step(i), value(keys[i + 1]), -1 / step(i), value(keys[i]));
  };
  const auto velocity_at = [&](size_t i) {
    if (i == 0 || i + 1 == keys.size()) return Vector{};
    return velocity(slope(i - 1), step(i - 1), slope(i), step(i));
  };
  const double h = step(first);
  const double t = std::clamp((time - keys[first].time) / h, 0.0, 1.0);
  const double s = 1 - t;
  // Cubic Hermite polynomials.
  const Vector places =
      scaled_sum(s * s * (1 + 2 * t), value(keys[first]), t * t * (1 + 2 * s), value(keys[first + 1]));
  const Vector pulls = scaled_sum(h * s * s * t, velocity_at(first), -h * t * t * s, velocity_at(first + 1));
  return scaled_sum(1, places, 1, pulls);
}

/// Spherical interpolation between the unit vectors `a` and `b`. If they are opposite, the rotation axis is arbitrary.
Vector turn(const Vector& a, const Vector& b, double t) {
  const double angle = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
  if (angle < 1e-6) return a;
  if (std::sin(angle) < 1e-6) {
    const Vector aside = std::abs(a[0]) < 0.7 ? Vector{1, 0, 0} : Vector{0, 1, 0};
    const Vector across = unit(scaled_sum(1, aside, -dot(aside, a), a));
    return scaled_sum(std::cos(angle * t), a, std::sin(angle * t), across);
  }
  return scaled_sum(std::sin((1 - t) * angle) / std::sin(angle), a, std::sin(t * angle) / std::sin(angle), b);
}

/// The component of `up` perpendicular to the view direction; `up` itself when the two are parallel.
Vector upright(const Vector& up, const Vector& view) {
  const Vector along = unit(view);
  const Vector part = scaled_sum(1, up, -dot(up, along), along);
  return length(part) > 1e-9 ? unit(part) : up;
}

Status check_path_camera(const wire::Camera& camera) {
  wire::DrawPicture picture;
  picture.set_model("any");
  *picture.mutable_camera() = camera;
  return check_picture(picture);
}

Result<Keyframe> read_keyframe(json document, size_t number) {
  const std::string name = "keyframe " + std::to_string(number) + ": ";
  if (!document.is_object() || !document.contains("time") || !document["time"].is_number()) {
    return invalid_input(name + "expected an object with a time");
  }
  Keyframe keyframe;
  keyframe.time = document["time"].get<double>();
  document.erase("time");
  if (!std::isfinite(keyframe.time)) return invalid_input(name + "the time must be finite");
  Status status = parse_camera_json(json_text(document), keyframe.camera);
  if (status) status = check_path_camera(keyframe.camera);
  if (!status) return invalid_input(name + status.error().message);
  return keyframe;
}

/// The camera of a saved view. Its display options and clip boxes are not of a path.
Result<wire::Camera> camera_of_view(const json& view) {
  if (!view.is_object() || !view.contains("parameters") || !view["parameters"].is_object()) {
    return invalid_input("expected an object with parameters");
  }
  wire::DrawPicture picture;
  picture.mutable_camera()->set_view_angle(kDefaultViewAngle);
  for (const char* field : {"position", "focal_point", "view_up", "view_angle"}) {
    const auto found = view["parameters"].find(field);
    if (found == view["parameters"].end()) continue;
    if (!found->is_string()) return invalid_input(std::string(field) + " must be a text");
    if (Status status = set_picture_field(picture, field, found->get<std::string>()); !status) {
      return invalid_input(std::string(field) + ": " + status.error().message);
    }
  }
  if (Status status = check_path_camera(picture.camera()); !status) return fail(status);
  return picture.camera();
}

Result<Keyframe> keyframe_of_view(const json& view, size_t number, double seconds_per_view) {
  Result<wire::Camera> camera = camera_of_view(view);
  if (!camera) return invalid_input("view " + std::to_string(number) + ": " + camera.error().message);
  return Keyframe{static_cast<double>(number) * seconds_per_view, std::move(*camera)};
}

/// Keyframes must have the same fields and ascending times.
Status check_order(const std::vector<Keyframe>& keyframes) {
  if (keyframes.size() < 2) return invalid_input("a path needs two keyframes or views");
  for (size_t i = 1; i < keyframes.size(); ++i) {
    const wire::Camera& first = keyframes[0].camera;
    const wire::Camera& camera = keyframes[i].camera;
    if (!(keyframes[i - 1].time < keyframes[i].time)) return invalid_input("times of keyframes must ascend");
    if (first.has_view_up() != camera.has_view_up() || first.has_view_angle() != camera.has_view_angle()) {
      return invalid_input("view_up and view_angle must be in all keyframes or views, or in none");
    }
  }
  return {};
}

}  // namespace

Result<CameraPath> CameraPath::parse(std::string_view text, double seconds_per_view) {
  const json document = parse_json_text(text);
  const auto has_array = [&](const char* name) {
    return document.is_object() && document.contains(name) && document[name].is_array();
  };
  const bool views = has_array("views");
  if (!views && !has_array("keyframes")) {
    return invalid_input("not a camera path: expected an object with an array of keyframes, or of views");
  }
  std::vector<Keyframe> keyframes;
  for (const json& entry : document[views ? "views" : "keyframes"]) {
    Result<Keyframe> keyframe =
        views ? keyframe_of_view(entry, keyframes.size(), seconds_per_view) : read_keyframe(entry, keyframes.size());
    if (!keyframe) return fail(keyframe);
    keyframes.push_back(std::move(*keyframe));
  }
  if (Status status = check_order(keyframes); !status) return fail(status);
  return CameraPath(std::move(keyframes));
}

Result<CameraPath> CameraPath::read(const std::string& file, double seconds_per_view) {
  const Result<MappedFile> mapped = MappedFile::open(file);
  if (!mapped) return fail(mapped);
  Result<CameraPath> path =
      parse({reinterpret_cast<const char*>(mapped->bytes().data()), mapped->bytes().size()}, seconds_per_view);
  if (!path) return fail_about(file, path);
  return path;
}

Result<int> CameraPath::frames(double per_second) const {
  // The margin keeps the last frame of a path whose duration is a whole number of frames despite rounding.
  const double count = (keyframes_.back().time - keyframes_.front().time) * per_second + 1e-6;
  if (count >= kMaxFrames) return fail(ErrorKind::kLimit, "the path has too many frames");
  return static_cast<int>(count) + 1;
}

wire::Camera CameraPath::camera_of(int number, double per_second) const {
  return camera_at(keyframes_.front().time + number / per_second);
}

wire::Camera CameraPath::camera_at(double time) const {
  size_t first = 0;
  while (first + 2 < keyframes_.size() && time >= keyframes_[first + 1].time) ++first;
  const auto at = [&](const auto& value) { return interpolate(keyframes_, first, time, value); };
  const Vector position = at([](const Keyframe& k) { return from_wire(k.camera.position()); });
  const Vector focal_point = at([](const Keyframe& k) { return from_wire(k.camera.focal_point()); });
  const Keyframe& a = keyframes_[first];
  const Keyframe& b = keyframes_[first + 1];
  wire::Camera camera;
  to_wire(position, camera.mutable_position());
  to_wire(focal_point, camera.mutable_focal_point());
  if (a.camera.has_view_up()) {
    const double t = std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
    const Vector up = turn(unit(from_wire(a.camera.view_up())), unit(from_wire(b.camera.view_up())), t);
    to_wire(upright(up, scaled_sum(1, focal_point, -1, position)), camera.mutable_view_up());
  }
  if (a.camera.has_view_angle()) {
    camera.set_view_angle(at([](const Keyframe& k) { return Vector{k.camera.view_angle(), 0, 0}; })[0]);
  }
  return camera;
}

Result<std::string> frame_name(std::string_view pattern, int number) {
  constexpr int kWidest = 20;
  std::string name;
  int numbers = 0;
  for (size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] != '%') {
      name += pattern[i];
      continue;
    }
    if (i + 1 < pattern.size() && pattern[i + 1] == '%') {
      name += pattern[++i];
      continue;
    }
    size_t end = i + 1;
    while (end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9') ++end;
    int width = 0;
    const auto read = std::from_chars(pattern.data() + i + 1, pattern.data() + end, width);
    const bool padded = end == i + 1 || pattern[i + 1] == '0';
    if (end == pattern.size() || pattern[end] != 'd' || !padded || width > kWidest ||
        read.ec == std::errc::result_out_of_range) {
      return invalid_input(std::string(pattern) + ": expected %d or %05d for the number of a frame");
    }
    const std::string digits = std::to_string(number);
    name.append(static_cast<size_t>(std::max(0, width - static_cast<int>(digits.size()))), '0');
    name += digits;
    ++numbers;
    i = end;
  }
  if (numbers != 1) return invalid_input(std::string(pattern) + ": the names of frames need one %d or %05d");
  return name;
}

}  // namespace surfcast::protocol
