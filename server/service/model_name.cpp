#include "service/model_name.h"

namespace surfcast::service {
namespace {

/// What no file's name contains.
constexpr char kNoName = '/';

}  // namespace

std::string model_name(const std::filesystem::path& path) {
  const bool folder = path.filename().empty();  // "name/"
  const std::filesystem::path named =
      folder || (path.filename() == "meta.json" && path.has_parent_path()) ? path.parent_path() : path;
  const std::filesystem::path name = named.filename();
  return name.extension() == ".gz" ? name.stem().stem().string() : name.stem().string();
}

std::string hidden_name(const std::string& name) {
  return kNoName + name;
}

std::string shown_name(const std::string& name) {
  return name.starts_with(kNoName) ? name.substr(1) : name;
}

}  // namespace surfcast::service
