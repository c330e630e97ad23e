#include <array>
#include <utility>

#include "base/ascii_text.h"
#include "scan/column_names.h"

namespace surfcast::scan {
namespace {

using Alias = std::pair<std::string_view, std::string_view>;

// Keys are in lower case, without underscores, hyphens, spaces and a leading "scalar".
constexpr std::array kAliases = {
    Alias{"x", "x"},
    Alias{"y", "y"},
    Alias{"z", "z"},
    Alias{"nx", "nx"},
    Alias{"ny", "ny"},
    Alias{"nz", "nz"},
    Alias{"normalx", "nx"},
    Alias{"normaly", "ny"},
    Alias{"normalz", "nz"},
    Alias{"red", "red"},
    Alias{"green", "green"},
    Alias{"blue", "blue"},
    Alias{"r", "red"},
    Alias{"g", "green"},
    Alias{"b", "blue"},
    Alias{"diffusered", "red"},
    Alias{"diffusegreen", "green"},
    Alias{"diffuseblue", "blue"},
    Alias{"rgb", "rgb"},
    Alias{"rgba", "rgba"},
    Alias{"alpha", "alpha"},
    Alias{"a", "alpha"},
    Alias{"diffusealpha", "alpha"},
    Alias{"radius", "radius"},
    Alias{"intensity", "intensity"},
    Alias{"i", "intensity"},
    Alias{"classification", "classification"},
    Alias{"class", "classification"},
    Alias{"classificationflags", "classification_flags"},
    Alias{"classflags", "classification_flags"},
    Alias{"scannerchannel", "scanner_channel"},
    Alias{"scanchannel", "scanner_channel"},
    Alias{"returnnumber", "return_number"},
    Alias{"numberofreturns", "number_of_returns"},
    Alias{"pointsourceid", "point_source_id"},
    Alias{"gpstime", "gps_time"},
    Alias{"userdata", "user_data"},
    Alias{"scananglerank", "scan_angle_rank"},
    Alias{"scanangle", "scan_angle"},
    Alias{"scandirectionflag", "scan_direction_flag"},
    Alias{"edgeofflightline", "edge_of_flight_line"},
    Alias{"nir", "nir"},
    Alias{"infrared", "nir"},
};

}  // namespace

std::string attribute_key(std::string_view name) {
  std::string key;
  for (const char c : name) {
    if (c != '_' && c != '-' && c != ' ') key += to_lower(c);
  }
  constexpr std::string_view kPrefix = "scalar";
  if (key.size() > kPrefix.size() && key.starts_with(kPrefix)) key.erase(0, kPrefix.size());
  return key;
}

std::string canonical_attribute_name(std::string_view name) {
  const std::string key = attribute_key(name);
  for (const auto& [alias, canonical] : kAliases) {
    if (alias == key) return std::string(canonical);
  }
  return std::string(name);
}

}  // namespace surfcast::scan
