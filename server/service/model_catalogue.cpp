#include "service/model_catalogue.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "surfel/even_sampling.h"

namespace surfcast::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".surf";

/// Adds the models of a folder whose names are not taken. A folder that cannot be read counts as empty.
void add_folder(const fs::path& folder, std::map<std::string, fs::path>& models) {
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    std::error_code ignored;
    if (entry->path().extension() == kExtension && entry->is_regular_file(ignored)) {
      models.emplace(entry->path().stem().string(), entry->path());
    }
  }
}

/// The median spacing over the surfels, to the resolution of leaves.
double typical_spacing(std::span<const ldc::BlockEntry> blocks) {
  std::vector<std::pair<double, uint64_t>> leaves;
  uint64_t surfels = 0;
  for (const ldc::BlockEntry& block : blocks) {
    if (block.level > 0) continue;
    leaves.emplace_back(block.spacing, block.surfels);
    surfels += block.surfels;
  }
  std::sort(leaves.begin(), leaves.end());
  uint64_t below = 0;
  for (const auto& [radius, count] : leaves) {
    below += count;
    if (2 * below >= surfels) return radius / surfel::kRadiusOverSpacing;
  }
  return 0;
}

}  // namespace

std::map<std::string, fs::path> ModelCatalogue::find_all() const {
  std::map<std::string, fs::path> models;
  for (const NamedModel& file : files_) models.emplace(file.name, file.path);
  for (const fs::path& folder : folders_) add_folder(folder, models);
  return models;
}

std::vector<std::string> ModelCatalogue::names() const {
  std::vector<std::string> names;
  for (const auto& [name, path] : find_all()) names.push_back(name);
  return names;
}

Result<std::shared_ptr<const model::ModelFile>> ModelCatalogue::open(const std::string& name) const {
  const auto models = find_all();
  const auto found = models.find(name);
  if (found == models.end()) return fail(ErrorKind::kNotFound, "there is no model '" + name + "'");
  const fs::path& path = found->second;
  std::error_code code;
  const fs::file_time_type written = fs::last_write_time(path, code);

  const std::lock_guard lock(mutex_);
  Opened& opened = opened_[name];
  if (opened.model && opened.path == path && opened.written == written && !code) return opened.model;
  Result<model::ModelFile> model = model::ModelFile::open(path);
  if (!model) {
    opened_.erase(name);
    return fail(model.error());
  }
  opened = {path, written, std::make_shared<const model::ModelFile>(std::move(*model))};
  return opened.model;
}

Result<ModelDescription> ModelCatalogue::describe(const std::string& name) const {
  const Result<std::shared_ptr<const model::ModelFile>> model = open(name);
  if (!model) return fail(model.error());
  ModelDescription description;
  description.info = (*model)->info();
  description.spacing = typical_spacing((*model)->blocks());
  description.blocks = static_cast<uint32_t>((*model)->blocks().size());
  for (const ldc::BlockEntry& block : (*model)->blocks()) {
    description.levels = std::max(description.levels, static_cast<uint32_t>(block.level + 1));
  }
  return description;
}

}  // namespace surfcast::service
