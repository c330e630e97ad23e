#include "protocol/request_flags.h"

#include <CLI/CLI.hpp>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/ascii_text.h"
#include "base/contract.h"
#include "base/json_text.h"
#include "base/mapped_file.h"
#include "protocol/camera_path.h"
#include "protocol/film.h"
#include "protocol/lights_file.h"
#include "protocol/pick_result_text.h"
#include "protocol/picture_fields.h"
#include "protocol/transfer_file.h"
#include "protocol/validate.h"

namespace surfcast::protocol {
namespace {

using nlohmann::json;

/// Files are of the command line alone: a server does not open what a client names.
bool names_file(std::string_view name, std::string_view text) {
  return (name == "transfer" || name == "lights") && text.ends_with(".json");
}

Status read_file(std::string_view name, const std::string& path, wire::DrawPicture& picture) {
  if (name == "lights") return read_lights_file(path, *picture.mutable_lighting());
  return read_transfer_file(path, *picture.mutable_transfer());
}

/// Checks a flag's value while the command line is parsed, so that an invalid value is a command line error. CLI11 puts
/// the flag's name before the message, so the field name at its start is removed.
std::string check_flag(std::string_view name, const std::string& text) {
  if (names_file(name, text)) return {};
  wire::DrawPicture scratch;
  const Status status = set_picture_field(scratch, name, text);
  if (status) return {};
  return status.error().message.substr(name.size() + 2);
}

/// The help of a field that may have another default.
std::string help_of(const PictureField& field, const std::string& other_default) {
  const std::string help(field.help);
  return other_default.empty() ? help : help.substr(0, help.find(" (default ")) + " (default " + other_default + ")";
}

bool read_number(const json& value, double& number) {
  if (!value.is_number()) return false;
  number = value.get<double>();
  return std::isfinite(number);
}

bool read_vector(const json& value, wire::Vector3* vector) {
  double x = 0;
  double y = 0;
  double z = 0;
  if (!value.is_array() || value.size() != 3) return false;
  if (!read_number(value[0], x) || !read_number(value[1], y) || !read_number(value[2], z)) return false;
  vector->set_x(x);
  vector->set_y(y);
  vector->set_z(z);
  return true;
}

bool read_camera_field(const std::string& key, const json& value, wire::Camera& camera) {
  if (key == "position") return read_vector(value, camera.mutable_position());
  if (key == "focal_point") return read_vector(value, camera.mutable_focal_point());
  if (key == "view_up") return read_vector(value, camera.mutable_view_up());
  double angle = 0;
  if (key != "view_angle" || !read_number(value, angle)) return false;
  camera.set_view_angle(angle);
  return true;
}

Status read_camera_file(const std::string& path, wire::Camera& camera) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  const std::string_view text(reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size());
  if (Status status = parse_camera_json(text, camera); !status) {
    return fail_about(path, status);
  }
  return {};
}

}  // namespace

std::string environment_name(std::string_view flag) {
  std::string name = "SURFCAST_";
  for (const char c : flag) name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

Status parse_camera_json(std::string_view text, wire::Camera& camera) {
  const json document = parse_json_text(text);
  if (!document.is_object()) return fail(ErrorKind::kInvalidInput, "not a JSON object");
  for (const auto& [key, value] : document.items()) {
    if (!read_camera_field(key, value, camera)) {
      return fail(ErrorKind::kInvalidInput, "'" + key + "' is not a field of a camera, or has a wrong value");
    }
  }
  return {};
}

void RequestFlags::set_default(std::string_view field, std::string_view text) {
  values_[std::string(field)] = std::string(text);
  defaults_[std::string(field)] = std::string(text);
}

void RequestFlags::add_to(CLI::App& command) {
  command
      .add_option("--output", output_,
                  "picture file; - is standard output and needs --format; with --path, a name with %d or %05d, or "
                  "that of a film (mp4, webm)")
      ->required()
      ->envname(environment_name("output"))
      ->type_name("FILE");
  add_view_flags_to(command);
  add_fields_to(command, true);
  command.add_option("--stats", stats_, "write the statistics of the picture as JSON")
      ->envname(environment_name("stats"))
      ->type_name("FILE");
  command.add_option("--path", path_, "draw the frames of a camera path, or of a flight through saved views (JSON)")
      ->envname(environment_name("path"))
      ->type_name("FILE");
  command.add_option("--fps", fps_, "frames per second of the camera path (default 30)")
      ->envname(environment_name("fps"))
      ->type_name("NUMBER")
      ->check(CLI::Range(0.001, 1000.0));
  command
      .add_option("--view-seconds", seconds_per_view_,
                  "seconds from one to the next of the saved views of --path (default 4)")
      ->envname(environment_name("view-seconds"))
      ->type_name("NUMBER")
      ->check(CLI::Range(0.001, 3600.0));
}

void RequestFlags::add_view_flags_to(CLI::App& command) {
  command.add_option("--camera", camera_file_, "camera as JSON: position, focal_point, view_up, view_angle")
      ->envname(environment_name("camera"))
      ->type_name("FILE");
  add_fields_to(command, false);
}

/// Adds the fields that are of picture files only, or all others.
void RequestFlags::add_fields_to(CLI::App& command, bool file) {
  for (const PictureField& field : picture_fields()) {
    if (field.file != file) continue;
    std::string& value = values_[std::string(field.name)];
    CLI::Option* option = command.add_option("--" + std::string(field.flag), value, help_of(field, value))
                              ->envname(environment_name(field.flag))
                              ->type_name(std::string(field.form))
                              ->check([name = field.name](const std::string& text) { return check_flag(name, text); });
    if (field.several) option->join(';');
  }
}

Result<wire::FileFormat> RequestFlags::format() const {
  if (is_film(output_)) return wire::FILE_FORMAT_PNG;  // of the frames
  if (const std::string& given = values_.at("format"); !given.empty()) return parse_file_format(given);
  if (output_ == "-") return fail(ErrorKind::kInvalidInput, "--output - needs --format");
  const std::string extension = lower_extension(output_);
  if (extension.empty()) {
    return fail(ErrorKind::kInvalidInput, output_ + ": give it an extension (png, jpg, webp, exr), or --format");
  }
  return parse_file_format(extension.substr(1)).map_error([this](const Error& error) {
    return Error{error.kind, output_ + ": " + error.message};
  });
}

Status RequestFlags::check() const {
  if (is_film(output_) && path_.empty()) {
    return fail(ErrorKind::kInvalidInput, output_ + ": a film needs the camera path --path");
  }
  if (is_film(output_) && !values_.at("format").empty()) {
    return fail(ErrorKind::kInvalidInput, "--format is of pictures, and " + output_ + " is a film");
  }
  const Result<wire::FileFormat> chosen = format();
  if (!chosen) return fail(chosen);
  if (!values_.at("channels").empty() && *chosen != wire::FILE_FORMAT_EXR) {
    return fail(ErrorKind::kInvalidInput, "--channels needs a picture in EXR format");
  }
  if (!path_.empty()) {
    if (!stats_.empty()) return fail(ErrorKind::kInvalidInput, "--stats is of one picture, and --path draws many");
    const Result<std::string> name = is_film(output_) ? output_ : frame_name(output_, 0);
    if (!name) return fail(name);
  }
  return check_view_flags();
}

Status RequestFlags::check_view_flags() const {
  const bool position = !values_.at("position").empty();
  const bool focal_point = !values_.at("focal_point").empty();
  const bool rest = !values_.at("view_up").empty() || !values_.at("view_angle").empty();
  if (camera_file_.empty() && (position || focal_point || rest) && !(position && focal_point)) {
    return fail(ErrorKind::kInvalidInput, "a camera needs --camera-position and --camera-focal-point");
  }
  return {};
}

Result<wire::DrawPicture> RequestFlags::request(std::string_view model) const {
  const Result<wire::FileFormat> chosen = format();
  SURFCAST_EXPECTS(chosen.has_value());
  return request(model, *chosen);
}

/// Whether a field has its default, which another one replaces.
bool RequestFlags::is_replaced(const std::string& field) const {
  const auto found = defaults_.find(field);
  const auto stated = [this](const char* name) { return values_.contains(name) && !values_.at(name).empty(); };
  return field == "spacing" && found != defaults_.end() && values_.at(field) == found->second &&
         (stated("error") || stated("time"));
}

Result<wire::DrawPicture> RequestFlags::view_request(std::string_view model) const {
  return request(model, std::nullopt);
}

Result<wire::DrawPicture> RequestFlags::request(std::string_view model, std::optional<wire::FileFormat> format) const {
  wire::DrawPicture picture;
  picture.set_model(std::string(model));
  if (!camera_file_.empty()) {
    if (Status status = read_camera_file(camera_file_, *picture.mutable_camera()); !status) {
      return fail(status);
    }
  }
  for (const auto& [name, text] : values_) {
    if (text.empty() || is_replaced(name)) continue;
    const Status status =
        names_file(name, text) ? read_file(name, text, picture) : set_picture_field(picture, name, text);
    if (!status) return fail(status);
  }
  if (format) picture.set_format(*format);
  if (Status status = check_picture(picture); !status) return fail(status);
  return picture;
}

void PickFlags::add_to(CLI::App& command) {
  command.add_option("--pixel", pixel_, "pixel, counted from the upper left corner")
      ->required()
      ->envname(environment_name("pixel"))
      ->type_name("X,Y")
      ->check([](const std::string& text) {
        wire::PickSurfel scratch;
        const Status status = set_pixel(scratch, text);
        return status ? std::string() : status.error().message;
      });
  view_flags_.add_view_flags_to(command);
  command.add_flag("--json", json_, "print JSON");
}

Result<wire::PickSurfel> PickFlags::request(std::string_view model) const {
  Result<wire::DrawPicture> picture = view_flags_.view_request(model);
  if (!picture) return fail(picture);
  wire::PickSurfel pick;
  *pick.mutable_picture() = std::move(*picture);
  if (Status status = set_pixel(pick, pixel_); !status) return fail(status);
  return pick;
}

Status PickFlags::print(const wire::PickResult& result) const {
  std::cout << (json_ ? pick_result_json(result) : pick_result_text(result));
  if (!std::cout.flush()) return fail(ErrorKind::kIo, "cannot write to standard output");
  return {};
}

}  // namespace surfcast::protocol
