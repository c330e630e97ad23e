#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "base/result.h"
#include "model/block_cache.h"
#include "model/model_file.h"
#include "object_store/object_store.h"
#include "point_tree/open_in_place.h"

namespace surfcast::cmd {

/// How scans are shown that are octrees of points.
struct InPlaceOptions {
  bool files = false;  ///< those of this machine, too, of which models are built else
  point_tree::InPlaceLimits limits;
};

/// `--in-place`, `--hierarchy-limit` and `--in-place-memory`. The target must outlive the parsing.
void add_in_place_flags(CLI::App& command, InPlaceOptions& options);

/// Whether a path or URL is opened in place.
[[nodiscard]] bool is_in_place(const std::filesystem::path& path, const InPlaceOptions& options);

/// Opens scans in place. The store outlives it, and its models.
class InPlaceOpener {
 public:
  InPlaceOpener(const object_store::ObjectStore& store, const InPlaceOptions& options,
                std::shared_ptr<model::BlockCache> cache)
      : store_(&store), options_(options), cache_(std::move(cache)) {}

  [[nodiscard]] bool opens(const std::filesystem::path& path) const { return is_in_place(path, options_); }
  /// `shown`: what errors call the object of a URL.
  [[nodiscard]] Result<model::ModelFile> open(const std::filesystem::path& path, const std::string& shown) const;

 private:
  [[nodiscard]] Result<model::ModelFile> open_stored(const std::string& url, const std::string& shown) const;

  const object_store::ObjectStore* store_;
  InPlaceOptions options_;
  std::shared_ptr<model::BlockCache> cache_;
};

}  // namespace surfcast::cmd
