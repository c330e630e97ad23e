#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "cmd/in_place_flags.h"
#include "cmd/scan_cache.h"
#include "service/model_catalogue.h"

namespace surfcast::cmd {

/// What a command line names.
struct NamedPaths {
  std::vector<service::NamedModel> models;     ///< they open
  std::vector<std::filesystem::path> folders;  ///< of models
  std::vector<std::filesystem::path> scans;    ///< files, and folders that are a scan
  std::vector<std::string> stores;             ///< URLs of folders of models
};

/// Sorts the paths and URLs of a command line. Fails if one does not exist, if a model does not open, if two have one
/// name, and if there is nothing but scans that are none by their first bytes.
Result<NamedPaths> sort_paths(std::span<const std::filesystem::path> paths, const object_store::ObjectStore& store,
                              const InPlaceOpener& in_place);

/// A catalogue and the name in it of what is asked for.
struct FoundModel {
  std::unique_ptr<service::ModelCatalogue> models;
  std::string name;
};

/// Finds a model by a model file, its URL, or a scan. Several are shown together: several paths, or "a.surf+b.surf"
/// where there is no file of that name. The store outlives the catalogue.
Result<FoundModel> find_shown_model(std::span<const std::filesystem::path> paths, const ScanCacheConfig& cache,
                                    const object_store::ObjectStore& store, const InPlaceOpener& in_place);

}  // namespace surfcast::cmd
