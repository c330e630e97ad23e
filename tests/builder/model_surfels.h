#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "model/model_file.h"

namespace surfcast::builder {

/// What a leaf has of a point of a TextScan.
struct Surfel {
  glm::dvec3 position;
  glm::vec3 normal;
  float radius;
  float weight;
  int intensity;
  bool scatter;
};

/// The surfels of all leaves of a model, by their numbers. Each number occurs once.
inline std::map<uint32_t, Surfel> surfels_of(const std::filesystem::path& path) {
  std::map<uint32_t, Surfel> surfels;
  const Result<model::ModelFile> model = model::ModelFile::open(path);
  EXPECT_TRUE(model) << model.error().message;
  for (size_t b = 0; b < model->blocks().size(); ++b) {
    const Result<model::DecodedBlock> block = model->decode(b);
    EXPECT_TRUE(block) << block.error().message;
    if (model->blocks()[b].level > 0) continue;
    const auto value = [&](const std::string& name, size_t i) {
      const auto scalar = std::ranges::find(block->scalars, name, &surfel::ScalarAttribute::name);
      return std::visit([i](const auto& values) { return static_cast<uint32_t>(values[i]); }, scalar->values);
    };
    for (size_t i = 0; i < block->size(); ++i) {
      const uint32_t number = value("number", i);
      EXPECT_EQ(surfels.count(number), 0U);
      surfels[number] = {block->position(i),
                         block->normals[i],
                         block->radii[i],
                         block->weights[i],
                         static_cast<int>(value("intensity", i)),
                         block->is_scatter(i)};
    }
  }
  return surfels;
}

}  // namespace surfcast::builder
