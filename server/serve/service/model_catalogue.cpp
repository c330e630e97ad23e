#include "service/model_catalogue.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "access/authorization.h"
#include "access/joined_name.h"
#include "base/contract.h"
#include "object_store/object_url.h"
#include "render/transfer_presets.h"
#include "service/model_name.h"
#include "service/place_members.h"
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

/// The models of a folder. One that cannot be read counts as empty.
std::map<std::string, fs::path> models_in(const fs::path& folder) {
  std::map<std::string, fs::path> models;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    std::error_code ignored;
    if (entry->path().extension() == kExtension && entry->is_regular_file(ignored)) {
      models.emplace(entry->path().stem().string(), entry->path());
    }
  }
  return models;
}

/// The median spacing over the surfels, to the resolution of leaves.
double typical_spacing(std::span<const ldc::BlockEntry> blocks) {
  std::vector<std::pair<double, uint64_t>> leaves;
  uint64_t surfels = 0;
  for (const ldc::BlockEntry& block : blocks) {
    if (block.level > 0) continue;
    leaves.emplace_back(block.spacing, block.items);
    surfels += block.items;
  }
  std::sort(leaves.begin(), leaves.end());
  uint64_t below = 0;
  for (const auto& [radius, count] : leaves) {
    below += count;
    if (2 * below >= surfels) return radius / surfel::kRadiusOverSpacing;
  }
  return 0;
}

/// The name under which a model alone is looked up: one that there is not, if it must not be the answer.
std::string name_alone(const std::string& served_name) {
  const access::ServedName wanted = access::parse_served_name(served_name);
  return wanted.alone ? wanted.name : served_name;
}

/// The members of a joined model, where they lie in it.
std::vector<MemberDescription> members_in(const model::ModelFile& model) {
  std::vector<MemberDescription> members;
  for (const model::Member& member : model.members()) {
    members.push_back({member.name, {}, member.model->info().kinds});
  }
  if (members.empty()) return members;
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    if (model.blocks()[block].level == 0)
      members[model.part(block).member].bounds.include(model.blocks()[block].bounds);
  }
  return members;
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

ModelCatalogue::ModelCatalogue(std::vector<NamedModel> files, std::vector<fs::path> folders,
                               const object_store::ObjectStore* store)
    : files_(std::move(files)), folders_(std::move(folders)), store_(store) {
  for (const NamedModel& file : files_) {
    if (!file.opened) continue;
    std::error_code ignored;
    const bool here = !object_store::is_object_url(file.path.string());
    opened_[file.name] = {file.path, here ? fs::last_write_time(file.path, ignored) : fs::file_time_type(),
                          file.opened};
  }
}

bool ModelCatalogue::set_stored(std::map<std::string, fs::path> models) {
  const std::lock_guard lock(listing_mutex_);
  return std::exchange(stored_, std::move(models)) != stored_;
}

/// To be called with listing_mutex_ locked.
const ModelCatalogue::Listing& ModelCatalogue::listing_of(const fs::path& folder) const {
  constexpr std::chrono::seconds kResolution{2};  // of the coarsest file systems in use
  std::error_code code;
  const fs::file_time_type written = fs::last_write_time(folder, code);
  Listing& listing = listings_[folder];
  if (listing.settled && !code && listing.written == written) return listing;
  const bool settled = !code && fs::file_time_type::clock::now() - written > kResolution;
  listing = {written, settled, models_in(folder)};
  return listing;
}

std::map<std::string, fs::path> ModelCatalogue::find_all() const {
  std::map<std::string, fs::path> models;
  for (const NamedModel& file : files_) models.emplace(file.name, file.path);
  const std::lock_guard lock(listing_mutex_);
  for (const fs::path& folder : folders_) {
    const Listing& listing = listing_of(folder);
    models.insert(listing.models.begin(), listing.models.end());
  }
  models.insert(stored_.begin(), stored_.end());
  return models;
}

bool ModelCatalogue::remote(const std::string& served_name) const {
  const std::vector<std::string> members = known_members_of(served_name);
  if (!members.empty()) return std::ranges::any_of(members, [this](const std::string& name) { return remote(name); });
  const std::string name = name_alone(served_name);
  const auto file = std::ranges::find(files_, name, &NamedModel::name);
  if (file != files_.end()) return file->open_in_place || object_store::is_object_url(file->path.string());
  const std::lock_guard lock(listing_mutex_);
  const auto holds = [&](const auto& listing) { return listing.second.models.contains(name); };
  return stored_.contains(name) && std::ranges::none_of(listings_, holds);
}

/// The file of a model; empty if there is none.
fs::path ModelCatalogue::find(const std::string& name) const {
  const auto file = std::ranges::find(files_, name, &NamedModel::name);
  if (file != files_.end()) return file->path;
  const std::lock_guard lock(listing_mutex_);
  for (const fs::path& folder : folders_) {
    const Listing& listing = listing_of(folder);
    if (const auto found = listing.models.find(name); found != listing.models.end()) return found->second;
  }
  const auto stored = stored_.find(name);
  return stored == stored_.end() ? fs::path() : stored->second;
}

void ModelCatalogue::close_removed() const {
  const std::map<std::string, fs::path> models = find_all();
  const std::lock_guard lock(mutex_);
  std::erase_if(opened_, [&](const auto& entry) { return !models.contains(entry.first); });
  std::erase_if(joined_, [&](const auto& entry) {
    return std::ranges::any_of(
        entry.first, [&](const std::string& member) { return !models.contains(member) && !scans_.contains(member); });
  });
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

bool ModelCatalogue::has_alone(const std::string& name) const {
  if (!find(name).empty()) return true;
  const std::lock_guard lock(mutex_);
  return scans_.contains(name);
}

/// The same by what is known of the folders since they were last read.
bool ModelCatalogue::known_alone(const std::string& name) const {
  if (std::ranges::find(files_, name, &NamedModel::name) != files_.end()) return true;
  {
    const std::lock_guard lock(listing_mutex_);
    const auto holds = [&](const auto& listing) { return listing.second.models.contains(name); };
    if (stored_.contains(name) || std::ranges::any_of(listings_, holds)) return true;
  }
  const std::lock_guard lock(mutex_);
  return scans_.contains(name);
}

/// The names of the models that are meant, if it is not one model alone, which `is_one` tells.
std::vector<std::string> ModelCatalogue::members_of(const std::string& served_name, IsOne is_one) const {
  const access::ServedName wanted = access::parse_served_name(served_name);
  if (!wanted.joined) return {};
  std::vector<std::string> members = access::members_of(wanted.name);
  if (!members.empty() && wanted.alone && (this->*is_one)(wanted.name)) return {};
  return members;
}

/// For decisions that are not to access the disk. None if there are too many.
std::vector<std::string> ModelCatalogue::known_members_of(const std::string& served_name) const {
  std::vector<std::string> members = members_of(served_name, &ModelCatalogue::known_alone);
  if (members.size() > model::kMaxMembers) members.clear();
  return members;
}

bool ModelCatalogue::has(const std::string& name) const {
  const std::vector<std::string> members = members_of(name, &ModelCatalogue::has_alone);
  if (members.empty()) return has_alone(name_alone(name));
  return std::ranges::all_of(members, [this](const std::string& member) { return has_alone(member); });
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

bool ModelCatalogue::awaited(const std::string& served_name) const {
  const std::vector<std::string> members = known_members_of(served_name);
  if (!members.empty()) return std::ranges::any_of(members, [this](const std::string& name) { return awaited(name); });
  const std::string name = name_alone(served_name);
  const std::lock_guard lock(mutex_);
  const auto found = scans_.find(name);
  return found != scans_.end() && found->second.edition == 0 &&
         found->second.status.state != ScanStatus::State::kFailed;
}

/// Of joined models the sum, which grows with each.
uint64_t ModelCatalogue::edition(const std::string& served_name) const {
  uint64_t sum = 0;
  const std::vector<std::string> members = known_members_of(served_name);
  for (const std::string& member : members) sum += edition(member);
  if (!members.empty()) return sum;
  const std::string name = name_alone(served_name);
  {
    const std::lock_guard lock(mutex_);
    if (const auto scan = scans_.find(name); scan != scans_.end()) return scan->second.edition;
    if (const auto file = shown_.find(name); file != shown_.end()) return file->second.edition;
  }
  return edition_of_file(name);
}

/// The first edition of a file on disk. None for other models: those of stores are watched by who lists the stores.
uint64_t ModelCatalogue::edition_of_file(const std::string& name) const {
  const fs::path path = find(name);
  if (path.empty() || object_store::is_object_url(path.string())) return 0;
  std::error_code code;
  const fs::file_time_type written = fs::last_write_time(path, code);
  if (code) return 0;
  const std::lock_guard lock(mutex_);
  return shown_.try_emplace(name, Shown{path, written}).first->second.edition;
}

void ModelCatalogue::look_for_replaced() {
  std::map<std::string, Shown> shown;
  {
    const std::lock_guard lock(mutex_);
    shown = shown_;
  }
  // Without the lock, because a file system may take its time.
  std::vector<std::pair<std::string, fs::file_time_type>> replaced;
  for (const auto& [name, file] : shown) {
    std::error_code code;
    const fs::file_time_type written = fs::last_write_time(file.path, code);
    if (!code && written != file.written) replaced.emplace_back(name, written);
  }
  if (replaced.empty()) return;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, written] : replaced) {
      Shown& file = shown_[name];
      file.written = written;
      ++file.edition;
    }
  }
  changed_(true);
}

Result<ModelCatalogue::Edition> ModelCatalogue::open_edition(const std::string& name, uint64_t edition) const {
  const std::vector<std::string> members = members_of(name, &ModelCatalogue::has_alone);
  return members.empty() ? open_alone(name_alone(name), edition) : open_joined(members);
}

Result<ModelCatalogue::Edition> ModelCatalogue::open_joined(const std::vector<std::string>& names) const {
  if (names.size() > model::kMaxMembers) {
    return fail(ErrorKind::kLimit, "at most " + std::to_string(model::kMaxMembers) + " models can be shown together");
  }
  std::vector<std::shared_ptr<const model::ModelFile>> models;
  auto in_use = std::make_shared<std::vector<std::shared_ptr<const void>>>();
  bool preview = false;
  for (const std::string& name : names) {
    Result<Edition> member = open_alone(name, 0);
    if (!member) return member;
    models.push_back(member->model);
    in_use->push_back(std::move(member->in_use));
    preview = preview || member->preview;
  }
  return join(names, std::move(models)).map([&](std::shared_ptr<const model::ModelFile> model) {
    return Edition{std::move(model), preview, in_use};
  });
}

/// The same model as long as the members are the same. Those used last are kept.
Result<std::shared_ptr<const model::ModelFile>> ModelCatalogue::join(
    const std::vector<std::string>& names, std::vector<std::shared_ptr<const model::ModelFile>> models) const {
  {
    const std::lock_guard lock(mutex_);
    const auto found = joined_.find(names);
    if (found != joined_.end() && found->second.members == models) {
      found->second.used = ++joins_;
      return found->second.model;
    }
  }
  std::vector<model::Member> members;
  for (size_t i = 0; i < names.size(); ++i) members.push_back({names[i], models[i]});
  if (Status placed = place_members(members); !placed) return fail(placed);
  Result<model::ModelFile> made = model::ModelFile::join(std::move(members));
  if (!made) return fail(made);
  const std::lock_guard lock(mutex_);
  Joined& joined = joined_[names];
  if (joined.members != models) {
    joined = {std::move(models), std::make_shared<const model::ModelFile>(std::move(*made))};
  }
  joined.used = ++joins_;
  std::shared_ptr<const model::ModelFile> model = joined.model;
  while (joined_.size() > kKeptJoins) {
    joined_.erase(std::ranges::min_element(joined_, {}, [](const auto& entry) { return entry.second.used; }));
  }
  return model;
}

Result<ModelCatalogue::Edition> ModelCatalogue::open_alone(const std::string& name, uint64_t edition) const {
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

Result<model::ModelFile> ModelCatalogue::open_path(const std::string& name, const std::string& shown,
                                                   const fs::path& path) const {
  const auto file = std::ranges::find(files_, name, &NamedModel::name);
  if (file != files_.end() && file->open_in_place) return file->open_in_place(shown);
  if (!object_store::is_object_url(path.string())) return model::ModelFile::open(path);
  SURFCAST_EXPECTS(store_ != nullptr);
  return store_->open(path.string(), shown);
}

/// A file is opened without a lock: a slow disk or store holds up only those who want that file.
Result<std::shared_ptr<const model::ModelFile>> ModelCatalogue::open_file(const std::string& name) const {
  const fs::path path = find(name);
  if (path.empty()) return fail(ErrorKind::kNotFound, "there is no model '" + access::shown_name(name) + "'");
  // An object that has been replaced in its store is known by an answer to a request for its blocks.
  const bool stored = object_store::is_object_url(path.string());
  std::error_code code;
  const fs::file_time_type written = stored ? fs::file_time_type() : fs::last_write_time(path, code);
  std::string shown = name;  // in errors, if it is in a store: what whoever opened it first called it
  const auto is_current = [&](const Opened& opened) {
    return opened.model && opened.path == path && opened.written == written && !code &&
           !opened.model->source().replaced();
  };
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = opened_.find(name); found != opened_.end()) {
      if (is_current(found->second)) return found->second.model;
      if (found->second.model && found->second.path == path) shown = found->second.model->source().name();
    }
  }
  Result<model::ModelFile> model = open_path(name, shown, path);
  const std::lock_guard lock(mutex_);
  Opened& opened = opened_[name];
  if (is_current(opened)) return opened.model;  // another thread was faster
  if (!model) {
    opened_.erase(name);
    return fail(model);
  }
  opened = {path, written, std::make_shared<const model::ModelFile>(std::move(*model))};
  return opened.model;
}

std::vector<std::shared_ptr<const model::ModelFile>> ModelCatalogue::opened_in_stores() const {
  std::vector<std::shared_ptr<const model::ModelFile>> models;
  const std::lock_guard lock(mutex_);
  for (const auto& [name, opened] : opened_) {
    if (opened.model && object_store::is_object_url(opened.path.string())) models.push_back(opened.model);
  }
  return models;
}

Result<ModelDescription> ModelCatalogue::describe(const std::string& name) const {
  const Result<std::shared_ptr<const model::ModelFile>> model = open(name);
  if (!model) return fail(model);
  Result<model::Georeference> georeference = (*model)->georeference();
  if (!georeference) return fail(georeference);
  ModelDescription description;
  description.georeference = std::move(*georeference);
  description.info = (*model)->info();
  description.spacing = typical_spacing((*model)->blocks());
  description.blocks = static_cast<uint32_t>((*model)->blocks().size());
  const std::span<const model::Volume> volumes = (*model)->volumes();
  description.volumes.assign(volumes.begin(), volumes.end());
  const std::span<const model::EllipsoidSource> ellipsoids = (*model)->ellipsoid_sources();
  description.ellipsoids.assign(ellipsoids.begin(), ellipsoids.end());
  for (const model::Volume& volume : volumes) description.presets.push_back(presets_of(volume));
  description.members = members_in(**model);
  for (const ldc::BlockEntry& block : (*model)->blocks()) {
    description.levels = std::max(description.levels, static_cast<uint32_t>(block.level + 1));
  }
  return description;
}

}  // namespace surfcast::service
