#include "model/model_file.h"

#include <filesystem>
#include <map>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "model/model_writer.h"
#include "model/test_clouds.h"

namespace surfcast {
namespace {

namespace fs = std::filesystem;

class ModelFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("model_file_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] ModelFile round_trip(const SurfelCloud& cloud) const {
    const fs::path path = folder_ / "model.surf";
    const Result<WriteReport> report = write_model(cloud, path, {});
    if (!report) ADD_FAILURE() << report.error().message;
    Result<ModelFile> model = ModelFile::open(path);
    if (!model) ADD_FAILURE() << model.error().message;
    return std::move(*model);
  }

  fs::path folder_;
};

TEST_F(ModelFileTest, EverySurfelOfASphereComesBack) {
  const SurfelCloud cloud = sphere_cloud(100000);
  const ModelFile model = round_trip(cloud);
  EXPECT_EQ(model.info().surfels, cloud.size());
  EXPECT_TRUE(model.info().oriented);
  size_t surfels = 0;
  for (size_t b = 0; b < model.blocks().size(); ++b) {
    const Result<DecodedBlock> block = model.decode(b);
    ASSERT_TRUE(block) << block.error().message;
    ASSERT_EQ(block->size(), model.blocks()[b].surfels);
    surfels += block->size();
    for (size_t i = 0; i < block->size(); ++i) {
      const glm::dvec3 p = block->position(i);
      ASSERT_NEAR(glm::length(p), 1, cloud.radii[0] / 256);
      ASSERT_GT(glm::dot(glm::normalize(p), glm::dvec3(block->normals[i])), 1 - 1.6e-6);
      const glm::dvec3 color = (p + 1.0) * 127.5;
      ASSERT_LT(glm::length(glm::dvec3(block->colors[i]) - color), 1);
    }
  }
  EXPECT_EQ(surfels, cloud.size());
}

}  // namespace
}  // namespace surfcast
