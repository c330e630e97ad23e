#include "protocol/lights_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/invalid_input.h"
#include "base/json_text.h"
#include "base/mapped_file.h"

namespace surfcast::protocol {
namespace {

using nlohmann::json;

constexpr double kExponent = 32;

/// The number of an object's field, at least 0; none if the field is something else.
std::optional<double> number_in(const json& object, const char* name, double absent) {
  const auto found = object.find(name);
  if (found == object.end()) return absent;
  if (!found->is_number() || !(found->get<double>() >= 0) || !std::isfinite(found->get<double>())) return std::nullopt;
  return found->get<double>();
}

bool read_direction(const json& object, wire::Vector3& direction) {
  const auto found = object.find("direction");
  if (found == object.end() || !found->is_array() || found->size() != 3) return false;
  for (const json& part : *found) {
    if (!part.is_number() || !std::isfinite(part.get<double>())) return false;
  }
  direction.set_x((*found)[0].get<double>());
  direction.set_y((*found)[1].get<double>());
  direction.set_z((*found)[2].get<double>());
  return direction.x() != 0 || direction.y() != 0 || direction.z() != 0;
}

Status read_light(const json& object, wire::Light& light) {
  if (!object.is_object() || !read_direction(object, *light.mutable_direction())) {
    return invalid_input("a light needs a direction of three numbers that are not all 0");
  }
  const std::optional<double> power = number_in(object, "power", 1);
  if (!power) return invalid_input("power: expected a number of at least 0");
  light.set_power(*power);
  return {};
}

}  // namespace

Status parse_lights_json(std::string_view text, wire::Lighting& lighting) {
  const json document = parse_json_text(text);
  if (!document.is_object()) return invalid_input("not a JSON object");
  const std::optional<double> ambient = number_in(document, "ambient", 0);
  const std::optional<double> specular = number_in(document, "specular", 0);
  const std::optional<double> exponent = number_in(document, "exponent", kExponent);
  if (!ambient || !specular || !exponent) {
    return invalid_input("ambient, specular and exponent: expected numbers of at least 0");
  }
  if (!document.contains("lights") || !document["lights"].is_array()) return invalid_input("expected a list of lights");
  wire::Lighting read;
  read.set_ambient(*ambient);
  read.set_specular(*specular);
  read.set_exponent(*exponent);
  for (const json& light : document["lights"]) {
    if (Status status = read_light(light, *read.add_lights()); !status) return status;
  }
  lighting = std::move(read);
  return {};
}

Status read_lights_file(const std::string& path, wire::Lighting& lighting) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  const std::string_view text(reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size());
  if (Status status = parse_lights_json(text, lighting); !status) {
    return fail_about(path, status);
  }
  return {};
}

}  // namespace surfcast::protocol
