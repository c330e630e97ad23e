#include "service/model_name.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace surfcast::service {
namespace {

/// Files that describe the folder that they lie in: SOG, EPT, Potree, 3D Tiles.
constexpr std::array<std::string_view, 5> kDescriptions{"meta.json", "ept.json", "cloud.js", "metadata.json",
                                                        "tileset.json"};

bool is_description(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return std::find(kDescriptions.begin(), kDescriptions.end(), name) != kDescriptions.end();
}

}  // namespace

std::string model_name(const std::filesystem::path& path) {
  const bool folder = path.filename().empty();  // "name/"
  const std::filesystem::path named =
      folder || (is_description(path) && path.has_parent_path()) ? path.parent_path() : path;
  const std::filesystem::path name = named.filename();
  return name.extension() == ".gz" ? name.stem().stem().string() : name.stem().string();
}

}  // namespace surfcast::service
