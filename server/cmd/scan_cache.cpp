#include "cmd/scan_cache.h"

#include <array>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>

#include "base/atomic_file.h"
#include "base/file_lock.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/scratch_folder.h"
#include "builder/build_model.h"
#include "builder/input_files.h"
#include "cmd/cache_eviction.h"
#include "cmd/input_flags.h"
#include "model/model_file.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

/// How models are built that are not built as by default.
std::string manner_of(const ScanCacheConfig& config) {
  std::string manner;
  if (config.radii != estimation::RadiusPolicy::kAuto)
    manner += fmt::format(" radii {}", static_cast<int>(config.radii));
  for (const std::string& argument : arguments_of(config.meshes)) manner += " " + argument;
  return manner;
}

/// Another release may build better models of the same scan, so its version is part of the key. So is how a model is
/// built, in the hash.
std::string key_of(const std::string& content_name, const ScanCacheConfig& config) {
  std::string hash = content_name;
  if (const std::string manner = manner_of(config); !manner.empty()) {
    const std::string both = hash + manner;
    hash = hash_name(std::as_bytes(std::span(both)));
  }
  return fmt::format("{}-{}.surf", SURFCAST_VERSION, hash);
}

/// Notes in a file that it is used now: its time of access, because that of writing tells readers when it was replaced.
void touch(const fs::path& path) {
  const std::array<timespec, 2> times{timespec{0, UTIME_NOW}, timespec{0, UTIME_OMIT}};
  (void)::utimensat(AT_FDCWD, path.c_str(), times.data(), 0);  // a folder that cannot be written evicts nothing either
}

/// A model that is used until this ends.
class ModelInUse {
 public:
  ModelInUse(fs::path path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) { touch(path_); }
  ~ModelInUse() { touch(path_); }
  ModelInUse(const ModelInUse&) = delete;
  ModelInUse& operator=(const ModelInUse&) = delete;

 private:
  fs::path path_;
  FileLock lock_;
};

/// The model of that name, if there is one and it is whole. It is locked before it is looked at: what is there then
/// stays.
std::optional<CachedModel> find_in_cache(const fs::path& path) {
  std::optional<FileLock> lock = FileLock::share(path);
  if (!model::ModelFile::open(path)) return std::nullopt;
  if (!lock) return CachedModel{path, nullptr};  // a file system without locks, where nobody can evict either
  return CachedModel{path, std::make_shared<const ModelInUse>(path, std::move(*lock))};
}

Result<fs::path> cache_folder(const ScanCacheConfig& config) {
  return config.folder.empty() ? default_cache_folder() : config.folder;
}

/// The name of the content of a scan: that of its file, or those of all its files. None as soon as it is cancelled.
Result<std::optional<std::string>> content_name(const fs::path& scan, const std::atomic<bool>& cancelled) {
  const Result<std::vector<fs::path>> files = builder::files_of_input(scan);
  if (!files) return fail(files);
  std::string names;
  for (const fs::path& file : *files) {
    const Result<MappedFile> content = MappedFile::open(file);
    if (!content) return fail(content);
    const std::optional<std::string> name = hash_name(content->bytes(), cancelled);
    if (!name) return std::optional<std::string>();
    names += *name;
  }
  return files->size() == 1 ? std::optional(names) : hash_name(std::as_bytes(std::span(names)), cancelled);
}

Status build_into(const fs::path& scan, const fs::path& target, const ScanCacheConfig& config) {
  spdlog::info("{}: building a model of it", scan.string());
  const std::array inputs{scan};
  builder::BuildOptions options;
  options.memory = config.build_memory;
  options.radii = config.radii;
  options.meshes = config.meshes;
  const Result<builder::BuildReport> report =
      builder::build_model(inputs, target, options, [](const builder::BuildStep&) {});
  if (!report) return fail(report);
  for (const std::string& note : report->scan.notes) spdlog::warn("{}", note);
  spdlog::info("{}: {} blocks in {:.1f} s", scan.string(), report->blocks, report->seconds);
  return {};
}

}  // namespace

Result<fs::path> default_cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/') {
    return fs::path(cache) / "surfcast";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
    return fs::path(home) / ".cache" / "surfcast";
  }
  return fail(ErrorKind::kIo, "there is no folder for built models: set XDG_CACHE_HOME or HOME, or give --cache");
}

void remove_abandoned(const ScanCacheConfig& config) {
  const Result<fs::path> folder = cache_folder(config);
  if (!folder) return;
  remove_abandoned_files(*folder);
  remove_abandoned_folders(*folder, kPreviewFolder);
}

Result<fs::path> ready_cache_folder(const ScanCacheConfig& config) {
  Result<fs::path> folder = cache_folder(config);
  if (!folder) return folder;
  std::error_code code;
  fs::create_directories(*folder, code);
  if (code) return fail(ErrorKind::kIo, folder->string() + ": cannot make the folder: " + code.message());
  return folder;
}

Result<CacheSlot> find_cache_slot(const fs::path& scan, const ScanCacheConfig& config,
                                  const std::atomic<bool>& cancelled) {
  const Result<fs::path> folder = ready_cache_folder(config);
  if (!folder) return fail(folder);
  const Result<std::optional<std::string>> name = content_name(scan, cancelled);
  if (!name) return fail(name);
  if (!*name) return fail(ErrorKind::kCancelled, scan.string() + ": cancelled");
  CacheSlot slot{*folder / key_of(**name, config), {}};
  slot.model = find_in_cache(slot.target);
  return slot;
}

Result<CachedModel> use_built_model(const fs::path& target, const ScanCacheConfig& config) {
  std::optional<CachedModel> model = find_in_cache(target);
  if (!model) return fail(ErrorKind::kIo, target.string() + ": another process removed the model that was just built");
  limit_cache(target.parent_path(), config.bytes);
  return std::move(*model);
}

Result<CachedModel> model_of_scan(const fs::path& scan, const ScanCacheConfig& config) {
  const std::atomic<bool> never{false};
  Result<CacheSlot> slot = find_cache_slot(scan, config, never);
  if (!slot) return fail(slot);
  if (!slot->model) {
    if (Status status = build_into(scan, slot->target, config); !status) return fail(status);
  }
  return use_built_model(slot->target, config);
}

}  // namespace surfcast::cmd
