#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "base/result.h"
#include "cmd/scan_cache.h"
#include "service/model_catalogue.h"

namespace surfcast::cmd {

/// The catalogue of what a command line names: model files, folders of them, and scans, which are built now unless the
/// cache has their models.
Result<std::unique_ptr<service::ModelCatalogue>> find_models(std::span<const std::filesystem::path> paths,
                                                             const ScanCacheConfig& cache);

/// The catalogue of one model, named by a model file or a scan.
Result<std::unique_ptr<service::ModelCatalogue>> find_one_model(const std::filesystem::path& path,
                                                                const ScanCacheConfig& cache);

}  // namespace surfcast::cmd
