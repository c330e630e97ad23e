#include "protocol/transfer_file.h"

#include <nlohmann/json.hpp>

#include "base/invalid_input.h"
#include "base/json_text.h"
#include "base/mapped_file.h"
#include "protocol/volume_fields.h"

namespace surfcast::protocol {
namespace {

using nlohmann::json;

/// The number of an object's field; none if it is no number.
std::optional<double> number_in(const json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

bool read_color(const json& object, wire::Color& color) {
  const auto found = object.find("color");
  if (found == object.end() || !found->is_array() || found->size() != 3) return false;
  for (const json& part : *found) {
    if (!part.is_number_unsigned() || part.get<uint64_t>() > 255) return false;
  }
  color.set_red((*found)[0].get<uint32_t>());
  color.set_green((*found)[1].get<uint32_t>());
  color.set_blue((*found)[2].get<uint32_t>());
  return true;
}

/// Parts out of range are refused by check_picture.
bool read_linear_color(const json& object, wire::Vector3& color) {
  const json& parts = object["color_linear"];
  if (!parts.is_array() || parts.size() != 3) return false;
  for (const json& part : parts) {
    if (!part.is_number()) return false;
  }
  color.set_x(parts[0].get<double>());
  color.set_y(parts[1].get<double>());
  color.set_z(parts[2].get<double>());
  return true;
}

bool read_any_color(const json& object, wire::TransferPoint& point) {
  if (object.contains("color_linear")) return read_linear_color(object, *point.mutable_color_linear());
  return read_color(object, *point.mutable_color());
}

Status read_point(const json& object, wire::TransferPoint& point) {
  const std::string wanted =
      "a point needs a value, a color of three numbers from 0 to 255 (or a color_linear, from 0 to 1), and an "
      "extinction "
      "or an opacity";
  if (!object.is_object()) return invalid_input(wanted);
  const auto value = number_in(object, "value");
  const auto extinction = number_in(object, "extinction");
  const auto opacity = number_in(object, "opacity");
  if (!value || !(extinction || opacity) || !read_any_color(object, point)) return invalid_input(wanted);
  point.set_value(*value);
  if (extinction) {
    point.set_extinction(*extinction);
  } else {
    point.set_opacity(*opacity);
  }
  return {};
}

Status read_preset(const json& document, wire::TransferFunction& transfer) {
  const json& name = document["preset"];
  const auto preset = name.is_string() ? parse_transfer_preset(name.get<std::string>()) : std::nullopt;
  if (!preset) return invalid_input("preset: expected auto, gray, ct-bone, ct-soft or mr");
  transfer.set_preset(*preset);
  if (const auto first = number_in(document, "first")) transfer.set_first(*first);
  if (const auto last = number_in(document, "last")) transfer.set_last(*last);
  return {};
}

Status read_points(const json& document, wire::TransferFunction& transfer) {
  if (!document.contains("points") || !document["points"].is_array()) {
    return invalid_input("not a transfer function: expected an object with points or a preset");
  }
  for (const json& entry : document["points"]) {
    if (Status status = read_point(entry, *transfer.add_points()); !status) return status;
  }
  return {};
}

}  // namespace

Status parse_transfer_json(std::string_view text, wire::TransferFunction& transfer) {
  const json document = parse_json_text(text);
  if (!document.is_object()) return invalid_input("not a JSON object");
  wire::TransferFunction read;
  Status status = document.contains("preset") ? read_preset(document, read) : read_points(document, read);
  if (status) transfer = std::move(read);
  return status;
}

Status read_transfer_file(const std::string& path, wire::TransferFunction& transfer) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  const std::string_view text(reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size());
  if (Status status = parse_transfer_json(text, transfer); !status) {
    return fail_about(path, status);
  }
  return {};
}

}  // namespace surfcast::protocol
