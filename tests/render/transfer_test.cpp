// Transfer functions of volumes, and what they leave to draw.

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "kinds/brick_block.h"
#include "model/model_writer.h"
#include "model/test_folder.h"
#include "render/clear_blocks.h"
#include "render/transfer_function.h"
#include "render/transfer_presets.h"
#include "render/volume_plan.h"

namespace surfcast::render {
namespace {

using picture::TransferPoint;

const glm::dvec3 kRed{1, 0, 0};
const glm::dvec3 kWhite{1, 1, 1};

TEST(TransferFunction, OpacitiesReferToTheSpacingAndExtinctionsAreLinearBetweenPoints) {
  const std::array points{TransferPoint{10, kRed, 0.2}, TransferPoint{20, kWhite, 0.6}};
  const TransferFunction transfer(points, 0.5);
  EXPECT_NEAR(transfer.at(15).extinction, -0.5 * (std::log(1 - 0.2) + std::log(1 - 0.6)) / 0.5, 1e-12);
  EXPECT_NEAR(transfer.at(-1e9).extinction, -std::log(1 - 0.2) / 0.5, 1e-12);
  EXPECT_NEAR(transfer.at(1e9).extinction, -std::log(1 - 0.6) / 0.5, 1e-12);
  EXPECT_EQ(transfer.at(15).color, glm::dvec3(1, 0.5, 0.5)) << "linear light";
}

TEST(TransferFunction, StatedExtinctionsDoNotDependOnTheSpacing) {
  const std::array points{TransferPoint{0, kRed, 0, 0.5}, TransferPoint{1, kRed, 0.2}, TransferPoint{2, kRed, 0, 1e6}};
  for (const double spacing : {0.25, 1.0, 4.0}) {
    const TransferFunction transfer(points, spacing);
    EXPECT_NEAR(transfer.at(0).extinction, 0.5, 1e-12);
    EXPECT_NEAR(transfer.at(0.5).extinction, 0.5 * (0.5 - std::log(1 - 0.2) / spacing), 1e-12);
    EXPECT_EQ(transfer.at(2).extinction, 256 / spacing);
  }
}

TEST(TransferFunction, AFactorOfTheOpacitiesIsOneOfTheOpacityOfASpacing) {
  const double spacing = 0.5;
  const std::array points{TransferPoint{0, kRed, 0.6}, TransferPoint{1, kRed, 0, -std::log(1 - 0.6) / spacing}};
  const TransferFunction transfer(points, spacing, 0.25);
  EXPECT_NEAR(transfer.at(0).extinction, -std::log(1 - 0.25 * 0.6) / spacing, 1e-12);
  EXPECT_NEAR(transfer.at(1).extinction, transfer.at(0).extinction, 1e-12);
  EXPECT_FALSE(TransferFunction(points, spacing, 0).visible_within(-1, 2));
}

TEST(TransferFunction, AnOpacityOfOneIsAFiniteExtinction) {
  const std::array points{TransferPoint{0, kRed, 1}};
  EXPECT_EQ(TransferFunction(points, 2).at(0).extinction, 8);
}

TEST(TransferFunction, PointsOfOneValueAreAStepInTheOrderStated) {
  const std::array points{TransferPoint{0, kRed, 0}, TransferPoint{1, kRed, 0}, TransferPoint{1, kWhite, 0.5}};
  const TransferFunction transfer(points, 1);
  EXPECT_EQ(transfer.at(0.999).extinction, 0);
  EXPECT_NEAR(transfer.at(1).extinction, -std::log(0.5), 1e-12);
}

TEST(TransferFunction, KnowsExactlyWhereSomethingIsSeen) {
  const std::array points{TransferPoint{0, kRed, 0}, TransferPoint{1, kRed, 0}, TransferPoint{2, kRed, 0.5},
                          TransferPoint{3, kRed, 0}};
  const TransferFunction transfer(points, 1);
  EXPECT_FALSE(transfer.visible_within(-5, 1));
  EXPECT_TRUE(transfer.visible_within(-5, 1.001));
  EXPECT_TRUE(transfer.visible_within(1.5, 1.6));
  EXPECT_TRUE(transfer.visible_within(-5, 50)) << "seen between values at which nothing is";
  EXPECT_FALSE(transfer.visible_within(3, 50));
  EXPECT_FALSE(TransferFunction({}, 1).visible_within(-1, 1));
}

TEST(TransferFunction, SumsOfTheTableAreTheIntegral) {
  const std::array points{TransferPoint{0, kRed, 0}, TransferPoint{1, kWhite, 0.5}, TransferPoint{4, kRed, 0.1}};
  const TransferFunction transfer(points, 1);
  const TransferTable table = transfer.table();
  // The middle bins, against sums of many values.
  constexpr int kValues = 100000;
  double extinction = 0;
  double red = 0;
  for (int i = 0; i < kValues; ++i) {
    const Classified seen = transfer.at(4 * (i + 0.5) / kValues);
    extinction += seen.extinction / kValues;
    red += seen.extinction * seen.color.x / kValues;
  }
  const size_t bins = table.sums.size() - 3;
  const glm::dvec4 sum = glm::dvec4(table.sums[bins + 1] - table.sums[1]) / static_cast<double>(bins);
  EXPECT_NEAR(sum.w * table.extinction_unit, extinction, 1e-6);
  EXPECT_NEAR(sum.x * table.color_unit, red, 1e-6);
  EXPECT_NEAR(1 + table.bins_per_value * (4 - table.first), static_cast<double>(bins) + 1, 1e-9);
}

model::Volume volume_of(double low, double high) {
  model::Volume volume;
  volume.size = {64, 32, 32};
  volume.low = low;
  volume.high = high;
  volume.histogram.assign(model::kHistogramBins, 0);
  return volume;
}

TEST(TransferPresets, ThoseForCtFollowTheUnitOfTheValues) {
  picture::Transfer bone;
  bone.preset = picture::TransferPreset::kCtBone;
  const auto expect_ends = [&](const model::Volume& volume, double first, double last) {
    const std::vector<TransferPoint> points = preset_points(bone, volume);
    EXPECT_NEAR(points.front().value, first, 1e-9);
    EXPECT_NEAR(points.back().value, last, 1e-9);
  };
  expect_ends(volume_of(-1024, 3071), 130, 1000);       // Hounsfield units
  expect_ends(volume_of(0, 255), 0.565 * 255, 255);     // 8 bits
  expect_ends(volume_of(0, 4095), 0.565 * 2000, 2000);  // from the lowest value on
  bone.first = 100;
  bone.last = 200;
  expect_ends(volume_of(0, 4095), 156.5, 200);  // stated
}

TEST(TransferPresets, GrayEndsWhereOneHundredthOfTheSamplesAreBrighter) {
  model::Volume volume = volume_of(0, 1024);
  volume.histogram[99] = 990;
  volume.histogram[1000] = 10;
  EXPECT_EQ(preset_points({}, volume).back().value, 100);
  EXPECT_NEAR(preset_points({}, volume).front().value, 5, 1e-12);
  volume.histogram.assign(model::kHistogramBins, 0);
  volume.histogram[0] = 1;
  EXPECT_GT(preset_points({}, volume).back().value, 0) << "a constant volume has a scale too";
}

std::vector<TransferPoint> automatic_points(const model::Volume& volume) {
  picture::Transfer transfer;
  transfer.preset = picture::TransferPreset::kAuto;
  return preset_points(transfer, volume);
}

TEST(AutomaticTransfer, ShowsSkinAndBoneOfHounsfieldUnits) {
  picture::Transfer soft;
  soft.preset = picture::TransferPreset::kCtSoft;
  const model::Volume volume = volume_of(-1024, 3071);
  EXPECT_EQ(automatic_points(volume), preset_points(soft, volume));
}

// Noise of Rayleigh's distribution below 60, tissue about 400, a bright vessel at 1000.
TEST(AutomaticTransfer, BeginsAboveTheNoiseOfMr) {
  model::Volume volume = volume_of(0, 1024);
  for (int i = 0; i < 60; ++i) {
    volume.histogram[static_cast<size_t>(i)] = static_cast<uint64_t>(4000 * i * std::exp(-i * i / 450.0));
  }
  for (size_t i = 300; i < 500; ++i) volume.histogram[i] = 900;
  volume.histogram[1000] = 2000;
  const std::vector<TransferPoint> points = automatic_points(volume);
  EXPECT_EQ(points.front().opacity, 0);
  EXPECT_GE(points.front().value, 60);
  EXPECT_LE(points.front().value, 300);
  EXPECT_GT(points.back().value, 450);
  EXPECT_GE(points.back().opacity, 0.5) << "the brightest values are seen at once";
}

TEST(AutomaticTransfer, LiesBetweenTheModesOfAnything) {
  model::Volume volume = volume_of(-3, 7);
  volume.histogram[100] = 50'000;
  volume.histogram[900] = 40'000;
  const double first = automatic_points(volume).front().value;
  EXPECT_GT(first, -3 + 10 * 100.0 / 1024);
  EXPECT_LE(first, -3 + 10 * 900.0 / 1024);
}

TEST(AutomaticTransfer, AscendsForVolumesThatSayNothing) {
  model::Volume empty = volume_of(0, 0);
  model::Volume constant = volume_of(5, 5);
  constant.histogram[0] = 1000;
  model::Volume nearly_constant = volume_of(0, 1);
  nearly_constant.histogram[0] = 1'000'000;
  nearly_constant.histogram[1023] = 1;
  for (const model::Volume& volume : {empty, constant, nearly_constant}) {
    const std::vector<TransferPoint> points = automatic_points(volume);
    for (size_t i = 1; i < points.size(); ++i) EXPECT_LT(points[i - 1].value, points[i].value);
  }
}

TEST(ClearBlocks, AreThoseInWhichTheirFunctionAndTheirDescendantsShowNothing) {
  const model::TestFolder folder;
  Result<model::ModelWriter> writer = model::ModelWriter::create(folder / "two.surf", {});
  ASSERT_TRUE(writer);
  const auto brick = [](uint32_t level, uint32_t i, float low, float high) {
    model::EncodedBlock block;
    block.bytes.assign(7, std::byte{42});
    block.items = 5;
    block.spacing = block.max_radius = level == 0 ? 1.0F : 2.0F;
    block.kind = model::kGridKind;
    block.brick = {0, level, {i, 0, 0}, low, high};
    return block;
  };
  const ldc::OctreeKey root;
  const std::vector<uint32_t> children{*writer->add(brick(0, 0, 0, 10), root.child(0), {}),
                                       *writer->add(brick(0, 1, 0, 50), root.child(1), {})};
  ASSERT_TRUE(writer->add(brick(1, 0, 0, 30), root, children));  // means have a smaller range
  model::Volume volume = volume_of(0, 50);
  volume.histogram.front() = volume.samples();
  writer->set_volumes({volume});
  ASSERT_TRUE(writer->finish());
  const Result<model::ModelFile> model = model::ModelFile::open(folder / "two.surf");
  ASSERT_TRUE(model) << model.error().message;
  const auto clear = [&](double first) {
    VolumeLook look;
    look.points = {{first, kRed, 0}, {first + 1, kRed, 0.5}};
    return clear_blocks(*model, look);
  };
  EXPECT_EQ(clear(200), (std::vector<bool>{true, true, true}));
  EXPECT_EQ(clear(60), (std::vector<bool>{false, true, false})) << "overshoots; the parent of what is seen is kept";
  EXPECT_EQ(clear(5), (std::vector<bool>{false, false, false}));
}

/// The plan of one brick of zeros with one sample of 1000, (9, 5, 1).
VolumePlan plan_of_one_sample(std::vector<TransferPoint> points) {
  volume::Brick brick;
  brick.header.count = glm::u32vec3(32);
  brick.header.scale = 1;
  brick.codes.assign(volume::stored_samples(brick.header.count), 0);
  brick.codes[(size_t{3} * 36 + 7) * 36 + 11] = 1000;
  const kinds::BrickBlock block(brick, glm::u32vec3(32), glm::dmat4x3(1.0));
  const std::array<uint32_t, 16> pages{};
  const std::array<VisibleBrick, 1> bricks{VisibleBrick{&block, pages}};
  VolumeLook look;
  look.points = std::move(points);
  const geometry::Camera camera{{16, 16, 100}, {16, 16, 16}, {0, 1, 0}, 30};
  return plan_volume(bricks, look, *geometry::make_camera_frame(camera, 64, 64), {0, 0, 64, 64});
}

bool seen_in(const VolumePlan& plan, const glm::ivec3& sub_brick) {
  return (plan.seen.at(static_cast<size_t>(layout::seen_word(sub_brick))) >> layout::seen_bit(sub_brick) & 1U) != 0;
}

TEST(VolumePlan, SubBricksAreSeenWhereReconstructionMayReachWhatTheFunctionShows) {
  const VolumePlan plan = plan_of_one_sample({{400, kRed, 0}, {500, kRed, 0.5}});
  ASSERT_EQ(plan.bricks.size(), 1U);
  ASSERT_EQ(plan.seen.size(), static_cast<size_t>(SURFCAST_SEEN_WORDS));
  for (int k = 0; k < 16; ++k) {
    for (int j = 0; j < 16; ++j) {
      for (int i = 0; i < 16; ++i) {
        EXPECT_EQ(seen_in(plan, {i, j, k}), i == 4 && j == 2 && k == 0) << i << ' ' << j << ' ' << k;
      }
    }
  }
}

TEST(VolumePlan, BricksOfWhichNothingIsSeenAreLeftOut) {
  const VolumePlan plan = plan_of_one_sample({{1500, kRed, 0}, {1600, kRed, 0.5}});
  EXPECT_TRUE(plan.bricks.empty());
  EXPECT_TRUE(plan.seen.empty());
  EXPECT_EQ(plan.cells, (std::vector<uint32_t>{SURFCAST_NO_CELL}));
}

}  // namespace
}  // namespace surfcast::render
