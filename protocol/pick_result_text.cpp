#include "protocol/pick_result_text.h"

#include <nlohmann/json.hpp>

#include "base/json_text.h"

namespace surfcast::protocol {
namespace {

using Json = nlohmann::ordered_json;

Json coordinates_of(const wire::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

Json document_of(const wire::PickResult& result) {
  Json document{{"hit", result.hit()}};
  if (!result.hit()) return document;
  document["position"] = coordinates_of(result.position());
  if (result.has_source_position()) document["source_position"] = coordinates_of(result.source_position());
  if (result.has_normal()) document["normal"] = coordinates_of(result.normal());
  if (result.has_color()) document["color"] = {result.color().red(), result.color().green(), result.color().blue()};
  document["radius"] = result.radius();
  document["distance"] = result.distance();
  document["depth"] = result.depth();
  document["surfel"] = result.surfel();
  if (!result.model().empty()) document["model"] = result.model();
  document["attributes"] = Json::object();
  for (const wire::AttributeValue& value : result.attributes()) {
    document["attributes"][value.attribute()] = value.value();
  }
  return document;
}

/// A value as text: "yes" or "no" for a boolean, numbers separated by blanks for a vector.
std::string plain(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (!value.is_array()) return json_text(value);
  std::string text;
  for (const Json& part : value) text += (text.empty() ? "" : " ") + json_text(part);
  return text;
}

}  // namespace

std::string pick_result_text(const wire::PickResult& result) {
  const Json document = document_of(result);  // items() refers to it
  std::string text;
  for (const auto& [name, value] : document.items()) {
    if (!value.is_object()) {
      text += name + ": " + plain(value) + "\n";
      continue;
    }
    for (const auto& [attribute, number] : value.items()) text += attribute + ": " + plain(number) + "\n";
  }
  return text;
}

std::string pick_result_json(const wire::PickResult& result) {
  return json_text(document_of(result), 2) + "\n";
}

}  // namespace surfcast::protocol
