#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "model/model_file.h"
#include "model/test_clouds.h"
#include "model/test_folder.h"
#include "model/write_model.h"

namespace surfcast::model {

inline ModelFile write_and_open(const surfel::SurfelCloud& cloud, const std::filesystem::path& path,
                                const WriteOptions& options = {}) {
  const Result<WriteReport> report = write_model(cloud, path, options);
  if (!report) throw std::runtime_error(report.error().message);
  Result<ModelFile> model = ModelFile::open(path);
  if (!model) throw std::runtime_error(model.error().message);
  return std::move(*model);
}

/// The location of a surfel in a model of a cloud with `number_surfels`.
struct Found {
  const DecodedBlock* block = nullptr;
  size_t index = 0;
};

/// The leaves of a model, and the location of each surfel by its number.
struct DecodedModel {
  std::vector<DecodedBlock> blocks;
  std::vector<Found> surfels;

  explicit DecodedModel(const ModelFile& model) : surfels(model.info().surfels) {
    for (size_t b = 0; b < model.blocks().size(); ++b) {
      if (model.blocks()[b].level > 0) continue;
      Result<DecodedBlock> block = model.decode(b);
      if (!block) throw std::runtime_error(block.error().message);
      blocks.push_back(std::move(*block));
    }
    for (const DecodedBlock& block : blocks) {
      const auto& ids = std::get<std::vector<uint32_t>>(block.scalars.back().values);
      for (size_t i = 0; i < ids.size(); ++i) surfels.at(ids[i]) = {&block, i};
    }
  }

  [[nodiscard]] glm::dvec3 position(size_t surfel) const {
    return surfels.at(surfel).block->position(surfels[surfel].index);
  }
};

/// Adds numbers to a cloud, writes it, and decodes the whole model.
inline DecodedModel round_trip(surfel::SurfelCloud cloud, const std::filesystem::path& path,
                               const WriteOptions& options = {}) {
  number_surfels(cloud);
  DecodedModel decoded(write_and_open(cloud, path, options));
  for (const Found& found : decoded.surfels) EXPECT_NE(found.block, nullptr);
  return decoded;
}

}  // namespace surfcast::model
