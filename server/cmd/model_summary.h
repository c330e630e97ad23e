#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "model/georeference.h"
#include "model/model_file.h"

namespace surfcast::cmd {

/// The blocks of one level together.
struct LevelSummary {
  int level = 0;
  uint64_t blocks = 0;
  uint64_t surfels = 0;
  uint64_t bytes = 0;           ///< of the encoded blocks
  double smallest_spacing = 0;  ///< of its blocks' medians, world units
  double largest_spacing = 0;
};

/// What `inspect` says about a model.
struct ModelSummary {
  std::filesystem::path path;
  uint64_t file_bytes = 0;
  model::ModelInfo info;
  std::vector<model::Volume> volumes;
  std::vector<LevelSummary> levels;  ///< finest first
  std::vector<model::EllipsoidSource> ellipsoids{};
  model::Georeference georeference{};

  /// Of the leaves, of all kinds.
  [[nodiscard]] uint64_t items() const {
    uint64_t sum = 0;
    for (const model::KindCount& kind : info.kinds) sum += kind.items;
    return sum;
  }
  /// Or per item of another kind.
  [[nodiscard]] double bytes_per_surfel() const {
    return static_cast<double>(file_bytes) / static_cast<double>(std::max<uint64_t>(items(), 1));
  }
};

ModelSummary summarize(const model::ModelFile& model, uint64_t file_bytes);

/// Lines of `name: value` for a person.
std::string to_text(const ModelSummary& summary);
std::string to_json(const ModelSummary& summary);
/// Several models: what all of them are as one, if that is known, with a list "members" of each.
std::string to_json(const std::vector<ModelSummary>& members, const ModelSummary* joined);

}  // namespace surfcast::cmd
