#include "cmd/find_models.h"

#include <algorithm>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "access/joined_name.h"
#include "base/mapped_file.h"
#include "builder/build_kinds.h"
#include "builder/input_files.h"
#include "cmd/open_members.h"
#include "object_store/object_url.h"
#include "scan/scan_folder.h"
#include "service/model_name.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

/// The model of a URL, opened. `shown`: what its errors call it.
Result<service::NamedModel> find_stored(const std::string& url, const std::string& shown,
                                        const object_store::ObjectStore& store) {
  if (!object_store::is_model_url(url)) {
    return fail(ErrorKind::kInvalidInput,
                shown + ": neither a model (.surf) nor a folder of models (with a / at its end)");
  }
  Result<model::ModelFile> model = store.open(url, shown);
  if (!model) return fail(model);
  return service::NamedModel{
      object_store::object_name(url), url, {}, std::make_shared<const model::ModelFile>(std::move(*model))};
}

/// The path of a scan by which it is named: "." has no name.
fs::path with_name(const fs::path& path) {
  const fs::path last = path.filename();
  if (last != "." && last != "..") return path;
  std::error_code code;
  const fs::path whole = fs::canonical(path, code);
  return code ? path : whole;
}

/// A scan that is shown in place, opened. `shown`: what its errors call it.
Result<service::NamedModel> find_in_place(const fs::path& path, const std::string& shown,
                                          const InPlaceOpener& in_place) {
  Result<model::ModelFile> model = in_place.open(path, shown);
  if (!model) return fail(model);
  const bool stored = object_store::is_object_url(path.string());
  service::NamedModel named;
  // A folder of a store is called like one of this machine.
  named.name = stored ? service::model_name(object_store::decode_percent(object_store::shown_url(path.string())))
                      : service::model_name(with_name(path));
  named.path = path;
  named.opened = std::make_shared<const model::ModelFile>(std::move(*model));
  named.open_in_place = [path, in_place](const std::string& name) { return in_place.open(path, name); };
  return named;
}

bool holds_models(const fs::path& folder) {
  std::error_code code;
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code)) {
    if (at->path().extension() == ".surf") return true;
  }
  return false;
}

/// A folder that is one scan of many files, or one model of Gaussians (SOG), not a folder of models.
bool is_scan_folder(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return false;
  return builder::holds_gaussians(path) || (scan::scan_folder_of(path) && !holds_models(path));
}

/// The model file of a path that is no folder of models; a scan is built now unless the cache has its model.
Result<service::NamedModel> find_model(const fs::path& path, const ScanCacheConfig& cache) {
  if (path.extension() != ".surf") {
    Result<CachedModel> built = model_of_scan(path, cache);
    if (!built) return fail(built);
    return service::NamedModel{service::model_name(with_name(path)), std::move(built->path), std::move(built->in_use)};
  }
  if (const Result<model::ModelFile> model = model::ModelFile::open(path); !model) return fail(model);
  return service::NamedModel{service::model_name(path), path};
}

Status check_file(const fs::path& path) {
  if (path.extension() == ".surf") return model::ModelFile::open(path).map([](const model::ModelFile&) {});
  if (is_scan_folder(path)) return {};
  return MappedFile::open(path).map([](const MappedFile&) {});
}

/// The names under which files are served must differ.
Status check_names(const NamedPaths& paths) {
  std::set<std::string> names;
  const auto add = [&names](const std::string& name, const fs::path& path) -> Status {
    if (names.insert(name).second) return {};
    return fail(ErrorKind::kInvalidInput, path.string() + ": another model is served under that name");
  };
  for (const service::NamedModel& model : paths.models) {
    if (Status status = add(model.name, model.path); !status) return status;
  }
  for (const fs::path& scan : paths.scans) {
    if (Status status = add(service::model_name(scan), scan); !status) return status;
  }
  return {};
}

/// Of several scans those that cannot be read are listed with their faults. If there is nothing else to serve, it is
/// the command line that is wrong.
Status check_any_scan(const NamedPaths& paths) {
  if (paths.scans.empty() || !paths.models.empty() || !paths.folders.empty() || !paths.stores.empty()) return {};
  Status first;
  for (const fs::path& scan : paths.scans) {
    Status status = builder::check_input(scan);
    if (status) return {};
    if (first) first = std::move(status);
  }
  return first;
}

Status sort_url(const std::string& url, const object_store::ObjectStore& store, const InPlaceOpener& in_place,
                NamedPaths& sorted) {
  if (url.ends_with('/')) {
    sorted.stores.push_back(url);
    return {};
  }
  const std::string name = object_store::object_name(url);
  Result<service::NamedModel> model =
      in_place.opens(url) ? find_in_place(url, name, in_place) : find_stored(url, name, store);
  if (!model) return fail_about(object_store::shown_url(url), model);
  sorted.models.push_back(std::move(*model));
  return {};
}

/// The model of a path or URL.
Result<service::NamedModel> find_one(const fs::path& path, const ScanCacheConfig& cache,
                                     const object_store::ObjectStore& store, const InPlaceOpener& in_place) {
  const std::string url = path.string();
  const bool stored = object_store::is_object_url(url);
  std::error_code ignored;
  if (stored ? url.ends_with('/') : fs::is_directory(path, ignored) && !is_scan_folder(path)) {
    return fail(ErrorKind::kInvalidInput, path.string() + ": expected one model, got a folder");
  }
  const std::string shown = stored ? object_store::shown_url(url) : url;
  if (in_place.opens(path)) return find_in_place(path, shown, in_place);
  return stored ? find_stored(url, shown, store) : find_model(path, cache);
}

void name_apart(std::vector<service::NamedModel>& models) {
  std::vector<std::string> names;
  names.reserve(models.size());
  for (const service::NamedModel& model : models) names.push_back(model.name);
  set_apart(names);
  for (size_t i = 0; i < models.size(); ++i) models[i].name = std::move(names[i]);
}

}  // namespace

Result<NamedPaths> sort_paths(std::span<const fs::path> paths, const object_store::ObjectStore& store,
                              const InPlaceOpener& in_place) {
  NamedPaths sorted;
  for (const fs::path& path : paths) {
    if (const std::string url = path.string(); object_store::is_object_url(url)) {
      if (Status status = sort_url(url, store, in_place, sorted); !status) return fail(status);
      continue;
    }
    if (in_place.opens(path)) {
      Result<service::NamedModel> model = find_in_place(path, path.string(), in_place);
      if (!model) return fail(model);
      sorted.models.push_back(std::move(*model));
      continue;
    }
    std::error_code ignored;
    if (fs::is_directory(path, ignored) && !is_scan_folder(path)) {
      sorted.folders.push_back(path);
      continue;
    }
    if (Status status = check_file(path); !status) return fail(status);
    if (path.extension() == ".surf") {
      sorted.models.push_back({service::model_name(path), path});
    } else {
      sorted.scans.push_back(with_name(path));
    }
  }
  if (Status status = check_names(sorted); !status) return fail(status);
  if (Status status = check_any_scan(sorted); !status) return fail(status);
  return sorted;
}

Result<FoundModel> find_shown_model(std::span<const fs::path> paths, const ScanCacheConfig& cache,
                                    const object_store::ObjectStore& store, const InPlaceOpener& in_place) {
  std::vector<service::NamedModel> files;
  for (const fs::path& path : members_of_paths(paths)) {
    Result<service::NamedModel> model = find_one(path, cache, store, in_place);
    if (!model) return fail(model);
    files.push_back(std::move(*model));
  }
  if (files.size() > 1) name_apart(files);
  std::string name = files.front().name;
  for (size_t i = 1; i < files.size(); ++i) name += access::kJoin + files[i].name;
  auto models = std::make_unique<service::ModelCatalogue>(std::move(files), std::vector<fs::path>(), &store);
  return FoundModel{std::move(models), std::move(name)};
}

}  // namespace surfcast::cmd
