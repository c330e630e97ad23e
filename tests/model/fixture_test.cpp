#include <cmath>

#include "model/round_trip.h"
#include "support/path_of.h"

namespace surfcast::model {
namespace {

/// The cloud of tests/data/sphere-and-grid-v2.surf, written when version 2 of the format was new. `build_subtree` used
/// leaves of at most 64 surfels, so the small file has coarser levels.
surfel::SurfelCloud fixture_cloud() {
  surfel::SurfelCloud cloud = sphere_cloud(200);
  const surfel::Grid grid{{0.01, 0.01, 0.01}, {500.3, -70.7, 12}};
  for (int i = 0; i < 50; ++i) cloud.positions.push_back(grid.position({i * i, 5 * i, -i}));
  cloud.sources = {{"sphere.ply", 0, 200, std::nullopt}, {"grid.las", 200, 50, grid}};
  cloud.colors->bits = 16;
  cloud.colors->values.resize(cloud.size(), glm::u16vec3(65535, 257, 0));
  cloud = finish_cloud(std::move(cloud));
  std::vector<double> times;
  for (size_t i = 0; i < cloud.size(); ++i) {
    times.push_back(1e9 + static_cast<double>(i) / 8);
    cloud.weights[i] = 1 / (1 + static_cast<float>(i));
  }
  cloud.scalars.push_back({"gps_time", std::move(times)});
  number_surfels(cloud);
  return cloud;
}

/// Every later version must read files of earlier ones correctly.
TEST(ModelFixture, OfVersionTwoIsStillRead) {
  const Result<ModelFile> model = ModelFile::open(path_of("tests/data") + "/sphere-and-grid-v2.surf");
  ASSERT_TRUE(model) << model.error().message;
  const surfel::SurfelCloud cloud = fixture_cloud();
  EXPECT_EQ(model->info().source_names, (std::vector<std::string>{"sphere.ply", "grid.las"}));
  EXPECT_EQ(model->info().scalar_names, (std::vector<std::string>{"gps_time", "id"}));
  ASSERT_EQ(model->info().surfels, cloud.size());
  EXPECT_GT(model->info().levels, 1);
  const DecodedModel decoded(*model);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const auto [block, at] = decoded.surfels[i];
    ASSERT_NE(block, nullptr);
    const double error = glm::length(decoded.position(i) - cloud.positions[i]);
    ASSERT_LE(error, i < 200 ? double{cloud.radii[i]} / 256 : 0.0);
    ASSERT_GT(glm::dot(block->normals[at], cloud.normals[i]), 0.999998f);
    ASSERT_NEAR(block->radii[at] / cloud.radii[i], 1, std::exp2(-11.5));
    ASSERT_NEAR(block->weights[at] / cloud.weights[i], 1, 0.011);
    ASSERT_EQ(block->colors[at], cloud.colors->values[i]);
    ASSERT_EQ(std::get<std::vector<double>>(block->scalars[0].values)[at],
              std::get<std::vector<double>>(cloud.scalars[0].values)[i]);
  }
}

TEST(ModelFixture, HasCoarseBlocksThatDecode) {
  const Result<ModelFile> model = ModelFile::open(path_of("tests/data") + "/sphere-and-grid-v2.surf");
  ASSERT_TRUE(model) << model.error().message;
  size_t coarse = 0;
  for (size_t b = 0; b < model->blocks().size(); ++b) {
    if (model->blocks()[b].level == 0) continue;
    const Result<DecodedBlock> block = model->decode(b);
    ASSERT_TRUE(block) << block.error().message;
    EXPECT_TRUE(block->scalars.empty());
    for (size_t i = 0; i < block->size() && model->blocks()[b].spacing < 0.5; ++i) {
      const glm::dvec3 p = block->position(i);
      if (glm::length(p) > 2) continue;  // a surfel of the grid
      EXPECT_NEAR(glm::length(p), 1, 0.05);
      EXPECT_GT(glm::dot(glm::normalize(p), glm::dvec3(block->normals[i])), 0.99);
      ++coarse;
    }
  }
  EXPECT_GT(coarse, 100U);
}

}  // namespace
}  // namespace surfcast::model
