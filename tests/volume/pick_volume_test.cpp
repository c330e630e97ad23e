// Picks and front surfaces of volumes.

#include <array>
#include <atomic>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "model/test_folder.h"
#include "pick/front_surface.h"
#include "pick/pick_surfel.h"
#include "service/sights.h"

namespace surfcast::pick {
namespace {

constexpr int kSide = 40;          ///< pixels
constexpr int kSamples = 64;       ///< along each axis
constexpr double kCentre = 31.5;   ///< of the volume
constexpr double kDistance = 100;  ///< of the eye from it
const std::atomic<bool> kNever{false};

/// 32 minus the distance from the centre, in steps of the grid.
class PickVolume : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream file(folder_ / "cone.nrrd", std::ios::binary);
    file << "NRRD0004\ntype: float\ndimension: 3\nsizes: 64 64 64\nspacings: 1 1 1\nencoding: raw\nendian: little\n\n";
    for (int n = 0; n < kSamples * kSamples * kSamples; ++n) {
      const glm::dvec3 at(n % kSamples, n / kSamples % kSamples, n / kSamples / kSamples);
      const auto value = static_cast<float>(32 - glm::length(at - kCentre));
      file.write(reinterpret_cast<const char*>(&value), sizeof value);
    }
    file.close();
    const auto report = builder::build_model(std::array{folder_ / "cone.nrrd"}, folder_ / "cone.surf", {},
                                             [](const builder::BuildStep&) {});
    ASSERT_TRUE(report) << report.error().message;
    model_ = std::make_unique<model::ModelFile>(std::move(*model::ModelFile::open(folder_ / "cone.surf")));
    request_.width = request_.height = kSide;
    request_.volumes.transfer.points = {{-100, glm::dvec3(1), 0}, {100, glm::dvec3(1), 0}};
  }

  [[nodiscard]] kinds::PickQuery query(int x, int y) const {
    const geometry::Camera camera{{kCentre, kCentre, kCentre - kDistance}, glm::dvec3(kCentre), {0, 1, 0}, 30};
    kinds::PickQuery query{*geometry::make_camera_frame(camera, kSide, kSide), {x + 0.5, y + 0.5}, request_.clip, {}};
    query.volumes = std::make_shared<const std::vector<kinds::VolumeSight>>(service::volume_sights(*model_, request_));
    return query;
  }
  std::optional<kinds::PickedSurfel> pick(int x, int y) {
    const auto picked = pick_surfel(*model_, query(x, y), blocks_, kNever);
    EXPECT_TRUE(picked) << (picked ? "" : picked.error().message);
    return picked ? *picked : std::nullopt;
  }
  /// Where the ray of a pixel enters the ball of this radius, camera z.
  [[nodiscard]] double ball_depth(int x, int y, double radius) const {
    const glm::dvec3 ray = query(x, y).frame.ray({x + 0.5, y + 0.5});
    const double length = glm::dot(ray, ray);
    return (kDistance - std::sqrt(kDistance * kDistance - length * (kDistance * kDistance - radius * radius))) / length;
  }

  model::TestFolder folder_;
  std::unique_ptr<model::ModelFile> model_;
  SourceBlocks blocks_{size_t{64} << 20};
  picture::PictureRequest request_;
};

TEST_F(PickVolume, APickOnAnIsoSurfaceHasItsValueAndTheIndex) {
  request_.volumes.isos = {{10}};
  for (const glm::ivec2 at : {glm::ivec2(20, 20), glm::ivec2(14, 23)}) {
    const auto picked = pick(at.x, at.y);
    ASSERT_TRUE(picked);
    EXPECT_NEAR(picked->depth, ball_depth(at.x, at.y, 22), 5e-3);
    ASSERT_EQ(picked->values.size(), 4u);
    EXPECT_EQ(picked->values[0].attribute, "value");
    EXPECT_NEAR(picked->values[0].value, 10, 5e-3);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(picked->values[axis + 1].value, picked->position[axis], 1e-9);
    EXPECT_NEAR(glm::length(picked->position - kCentre), 22, 5e-3);
    EXPECT_GT(glm::dot(picked->normal, glm::normalize(picked->position - kCentre)), 0.9999);
  }
  EXPECT_FALSE(pick(0, 0));
}

TEST_F(PickVolume, APickGoesThroughWhatTakesLessThanHalfOfTheLight) {
  request_.volumes.isos = {{5, glm::dvec3(1), 0.4}, {10}};
  EXPECT_NEAR(pick(20, 20)->depth, ball_depth(20, 20, 22), 5e-3);
  request_.volumes.isos[0].opacity = 0.6;
  EXPECT_NEAR(pick(20, 20)->depth, ball_depth(20, 20, 27), 5e-3);
  request_.opacity = 0.5;
  request_.volumes.isos = {{5}, {10}};
  EXPECT_NEAR(pick(20, 20)->depth, ball_depth(20, 20, 27), 5e-3);
}

TEST_F(PickVolume, APickInTheMediumIsWhereHalfOfTheLightIsLeft) {
  const double opacity = 0.05;  // of a step
  request_.volumes.transfer.points = {{-100, glm::dvec3(1), opacity}, {100, glm::dvec3(1), opacity}};
  const auto picked = pick(20, 20);
  ASSERT_TRUE(picked);
  const glm::dvec3 ray = query(20, 20).frame.ray({20.5, 20.5});
  const double expected = kDistance - kCentre + std::log(0.5) / std::log1p(-opacity) / glm::length(ray);
  EXPECT_NEAR(picked->depth, expected, 0.5);
  request_.volumes.medium = false;
  EXPECT_FALSE(pick(20, 20));
}

TEST_F(PickVolume, ASliceIsPickedWhereItIs) {
  request_.volumes.slices = {{.axis = 2, .index = 40.25}};
  const auto picked = pick(20, 20);
  ASSERT_TRUE(picked);
  EXPECT_NEAR(picked->depth, kDistance - kCentre + 40.25, 1e-9);
  request_.clip.outside.push_back({{0, 0, 40}, {64, 64, 41}});
  EXPECT_FALSE(pick(20, 20));
}

TEST_F(PickVolume, TheFrontSurfaceIsThatOfPicks) {
  request_.volumes.isos = {{10, glm::dvec3(1), 0.6}};
  request_.volumes.slices = {{{kCentre, kCentre, kCentre}, {0, 1, 1}}};
  const auto front = find_front_surface(*model_, query(0, 0), blocks_, kNever);
  ASSERT_TRUE(front);
  for (int y = 0; y < kSide; y += 3) {
    for (int x = 0; x < kSide; x += 3) {
      const auto picked = pick(x, y);
      const FrontPixel& pixel = (*front)[static_cast<size_t>(y) * kSide + static_cast<size_t>(x)];
      ASSERT_EQ(picked.has_value(), pixel.number != FrontPixel::kBackground) << x << ' ' << y;
      if (!picked) continue;
      EXPECT_EQ(picked->depth, pixel.depth);
      EXPECT_EQ(picked->number, pixel.number);
    }
  }
}

}  // namespace
}  // namespace surfcast::pick
