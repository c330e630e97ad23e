#include "cmd/find_models.h"

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

/// The model file behind a path that is no folder; it must open.
Result<service::NamedModel> find_model(const fs::path& path, const ScanCacheConfig& cache) {
  if (path.extension() != ".surf") {
    Result<CachedModel> built = model_of_scan(path, cache);
    if (!built) return fail(built.error());
    return service::NamedModel{path.stem().string(), std::move(built->path), std::move(built->in_use)};
  }
  if (const Result<model::ModelFile> model = model::ModelFile::open(path); !model) return fail(model.error());
  return service::NamedModel{path.stem().string(), path};
}

}  // namespace

Result<std::unique_ptr<service::ModelCatalogue>> find_models(std::span<const fs::path> paths,
                                                             const ScanCacheConfig& cache) {
  std::vector<service::NamedModel> files;
  std::vector<fs::path> folders;
  for (const fs::path& path : paths) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
      folders.push_back(path);
      continue;
    }
    Result<service::NamedModel> model = find_model(path, cache);
    if (!model) return fail(model.error());
    const bool taken =
        std::ranges::any_of(files, [&](const service::NamedModel& other) { return other.name == model->name; });
    if (taken) return fail(ErrorKind::kInvalidInput, path.string() + ": another model is served under that name");
    files.push_back(std::move(*model));
  }
  return std::make_unique<service::ModelCatalogue>(std::move(files), std::move(folders));
}

Result<std::unique_ptr<service::ModelCatalogue>> find_one_model(const fs::path& path, const ScanCacheConfig& cache) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    return fail(ErrorKind::kInvalidInput, path.string() + ": is a folder, and one model is wanted");
  }
  return find_models({&path, 1}, cache);
}

}  // namespace surfcast::cmd
