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

/// The catalogue of one model, named by a model file, its URL, or a scan. The store outlives it.
Result<std::unique_ptr<service::ModelCatalogue>> find_one_model(const std::filesystem::path& path,
                                                                const ScanCacheConfig& cache,
                                                                const object_store::ObjectStore& store,
                                                                const InPlaceOpener& in_place);

}  // namespace surfcast::cmd
