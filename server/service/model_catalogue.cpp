#include "service/model_catalogue.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "render/transfer_presets.h"
#include "surfel/even_sampling.h"

namespace surfcast::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".surf";

VolumePresets presets_of(const model::Volume& volume) {
  VolumePresets presets;
  for (size_t i = 0; i < presets.size(); ++i) {
    picture::Transfer transfer;
    transfer.preset = static_cast<picture::TransferPreset>(i);
    presets[i] = render::preset_points(transfer, volume);
  }
  return presets;
}

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

/// Why a scan cannot be drawn.
Error why_not(const ScanStatus& scan) {
  switch (scan.state) {
    case ScanStatus::State::kFailed:
      return {ErrorKind::kInvalidInput, scan.problem};
    case ScanStatus::State::kWaiting:
      return {ErrorKind::kUnavailable, "the model '" + scan.model + "' waits to be built"};
    case ScanStatus::State::kBuilding:
      break;
  }
  return {ErrorKind::kUnavailable, "the model '" + scan.model + "' is being built"};
}

}  // namespace

std::map<std::string, fs::path> ModelCatalogue::find_all() const {
  std::map<std::string, fs::path> models;
  for (const NamedModel& file : files_) models.emplace(file.name, file.path);
  for (const fs::path& folder : folders_) add_folder(folder, models);
  return models;
}

bool ModelCatalogue::add_scan(const std::string& name) {
  {
    const std::lock_guard lock(mutex_);
    const bool taken = std::ranges::any_of(files_, [&](const NamedModel& file) { return file.name == name; });
    if (taken || scans_.contains(name)) return false;
    scans_[name].status.model = name;
  }
  changed_(false);
  return true;
}

bool ModelCatalogue::has(const std::string& name) const {
  if (find_all().contains(name)) return true;
  const std::lock_guard lock(mutex_);
  return scans_.contains(name);
}

void ModelCatalogue::note(const ScanStatus& status) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = scans_.find(status.model);
    if (found == scans_.end() || found->second.complete) return;
    found->second.status = status;
    found->second.status.edition = found->second.edition;
  }
  changed_(false);
}

void ModelCatalogue::publish(const std::string& name, Edition edition) {
  {
    const std::lock_guard lock(mutex_);
    Scan& scan = scans_[name];
    scan.status.model = name;
    scan.status.edition = ++scan.edition;
    scan.complete = !edition.preview;
    scan.former = std::exchange(scan.newest, std::move(edition));
  }
  changed_(true);
}

std::vector<std::string> ModelCatalogue::names() const {
  std::map<std::string, fs::path> found = find_all();
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, scan] : scans_) {
      if (scan.status.state != ScanStatus::State::kFailed || scan.edition > 0) found.emplace(name, fs::path());
    }
  }
  std::vector<std::string> names;
  names.reserve(found.size());
  for (const auto& [name, path] : found) names.push_back(name);
  return names;
}

std::vector<ScanStatus> ModelCatalogue::scans() const {
  const std::lock_guard lock(mutex_);
  std::vector<ScanStatus> incomplete;
  for (const auto& [name, scan] : scans_) {
    if (!scan.complete) incomplete.push_back(scan.status);
  }
  return incomplete;
}

bool ModelCatalogue::awaited(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = scans_.find(name);
  return found != scans_.end() && found->second.edition == 0 &&
         found->second.status.state != ScanStatus::State::kFailed;
}

uint64_t ModelCatalogue::edition(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = scans_.find(name);
  return found == scans_.end() ? 0 : found->second.edition;
}

Result<ModelCatalogue::Edition> ModelCatalogue::open_edition(const std::string& name, uint64_t edition) const {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = scans_.find(name); found != scans_.end()) {
      const Scan& scan = found->second;
      if (scan.edition == 0) return fail(why_not(scan.status));
      return edition + 1 == scan.edition && scan.former.model ? scan.former : scan.newest;
    }
  }
  return open_file(name).map([](std::shared_ptr<const model::ModelFile> model) { return Edition{std::move(model)}; });
}

Result<std::shared_ptr<const model::ModelFile>> ModelCatalogue::open(const std::string& name) const {
  return open_edition(name, 0).map([](const Edition& edition) { return edition.model; });
}

Result<std::shared_ptr<const model::ModelFile>> ModelCatalogue::open_file(const std::string& name) const {
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
  const std::span<const model::Volume> volumes = (*model)->volumes();
  description.volumes.assign(volumes.begin(), volumes.end());
  for (const model::Volume& volume : volumes) description.presets.push_back(presets_of(volume));
  for (const ldc::BlockEntry& block : (*model)->blocks()) {
    description.levels = std::max(description.levels, static_cast<uint32_t>(block.level + 1));
  }
  return description;
}

}  // namespace surfcast::service
