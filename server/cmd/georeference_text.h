#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "model/georeference.h"

namespace surfcast::cmd {

/// The name of a system and its code, if it has one: "ETRS89 / UTM zone 32N (EPSG:25832)".
inline std::string name_of(const model::CoordinateSystem& system) {
  return system.id.empty() ? system.name : system.name + " (" + system.id + ")";
}

inline nlohmann::ordered_json json_of(const model::CoordinateSystem& system) {
  return {{"name", system.name}, {"id", system.id}, {"wkt", system.wkt}};
}

inline nlohmann::ordered_json json_of(const model::Georeference& georeference) {
  nlohmann::ordered_json json = json_of(georeference.system);
  if (georeference.source.known()) json["source"] = json_of(georeference.source);
  return json;
}

}  // namespace surfcast::cmd
