#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grid/grid_files.h"
#include "support/packing.h"

namespace surfcast::grid {
namespace {

using ::testing::ElementsAre;
using testing::expect_ramp;
using testing::fault_of;
using ::testing::HasSubstr;
using testing::nifti_header;
using testing::NiftiSettings;
using testing::ramp_bytes;
using testing::world;
using testing::write;

GridHeader expect_settings(const std::filesystem::path& path, const NiftiSettings& settings) {
  return expect_ramp(write(path, nifti_header(settings) + ramp_bytes(settings.big)));
}

TEST(NiftiTest, BothVersionsAreReadInBothByteOrders) {
  const model::TestFolder folder;
  for (const int version : {1, 2}) {
    for (const bool big : {false, true}) {
      SCOPED_TRACE(version * 10 + (big ? 1 : 0));
      NiftiSettings settings;
      settings.version = version;
      settings.big = big;
      settings.slope = 0.5;
      settings.intercept = -1000;
      settings.sform = 1;
      settings.rows = {-2, 0, 0.5, 100, 0, 3, 0, -50, 0, 0, 4, 25};
      const GridHeader header = expect_settings(folder / "grid.nii", settings);
      EXPECT_EQ(header.slope, 0.5);
      EXPECT_EQ(header.intercept, -1000);
      EXPECT_EQ(header.length_unit, "mm");
      EXPECT_EQ(header.frame, WorldFrame::kRas);
      EXPECT_EQ(world(header, 0, 0, 0), glm::dvec3(100, -50, 25));
      EXPECT_EQ(world(header, 1, 1, 1), glm::dvec3(98.5, -47, 29));
    }
  }
}

TEST(NiftiTest, SformGoesBeforeQformAndQformBeforeSpacing) {
  const model::TestFolder folder;
  NiftiSettings settings;
  settings.spacing = {-1, 2, 3, 4};
  settings.quaternion = {0, 0, std::sqrt(0.5), 10, 20, 30};  // a quarter turn about z
  settings.rows = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const GridHeader plain = expect_settings(folder / "a.nii", settings);
  EXPECT_EQ(plain.frame, WorldFrame::kUnstated);
  EXPECT_EQ(world(plain, 1, 1, 1), glm::dvec3(2, 3, 4));
  settings.qform = 1;
  const GridHeader turned = expect_settings(folder / "b.nii", settings);
  EXPECT_EQ(turned.frame, WorldFrame::kRas);
  EXPECT_NEAR(glm::distance(world(turned, 1, 0, 0), glm::dvec3(10, 22, 30)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(world(turned, 0, 1, 0), glm::dvec3(7, 20, 30)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(world(turned, 0, 0, 1), glm::dvec3(10, 20, 26)), 0, 1e-6);  // the sign of spacing[0]
  settings.sform = 2;
  EXPECT_EQ(world(expect_settings(folder / "c.nii", settings), 1, 1, 1), glm::dvec3(1, 1, 1));
}

TEST(NiftiTest, ASlopeOfZeroOrNotANumberMeansUnscaled) {
  const model::TestFolder folder;
  for (const double slope : {0.0, std::nan("")}) {
    NiftiSettings settings;
    settings.slope = slope;
    settings.intercept = 5;
    const GridHeader header = expect_settings(folder / "grid.nii", settings);
    EXPECT_EQ(header.slope, 1);
    EXPECT_EQ(header.intercept, 0);
  }
}

TEST(NiftiTest, PairsOfHeaderAndImageAreRead) {
  const model::TestFolder folder;
  NiftiSettings settings;
  settings.pair = true;
  const auto path = write(folder / "grid.hdr", nifti_header(settings));
  EXPECT_THAT(fault_of(path), HasSubstr(".img"));
  write(folder / "grid.img.gz", testing::gzip(ramp_bytes()));
  expect_ramp(path);
  write(folder / "grid.img", ramp_bytes());
  expect_ramp(path);
  expect_ramp(write(folder / "grid.hdr.gz", testing::gzip(nifti_header(settings))));
}

TEST(NiftiTest, TensorsOfTheirIntentAreBroughtTogetherFromPlanes) {
  const model::TestFolder folder;
  NiftiSettings settings;
  settings.type = 2;
  settings.intent = 1005;
  settings.sizes = {2, 1, 1, 1, 6};
  const std::string planes = std::string("ABCDEFGHIJKL");  // xx of both samples, then xy, and so on
  for (const bool packed : {false, true}) {
    const std::string text = nifti_header(settings) + planes;
    Result<GridReader> reader = GridReader::open(write(folder / "grid.nii", packed ? testing::gzip(text) : text));
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ(reader->header().kind, SampleKind::kSymmetricTensorLower);
    EXPECT_THAT(testing::read_values(*reader).value(),
                ElementsAre('A', 'C', 'E', 'G', 'I', 'K', 'B', 'D', 'F', 'H', 'J', 'L'));
  }
}

TEST(NiftiTest, WhatIsNotReadIsNamed) {
  const model::TestFolder folder;
  const auto fault = [&](const NiftiSettings& settings) {
    return fault_of(write(folder / "grid.nii", nifti_header(settings) + ramp_bytes()));
  };
  const auto with_type = [](int16_t type) {
    NiftiSettings settings;
    settings.type = type;
    return settings;
  };
  const auto with_sizes = [](std::vector<int64_t> sizes) {
    NiftiSettings settings;
    settings.sizes = std::move(sizes);
    return settings;
  };
  EXPECT_THAT(fault(with_type(128)), HasSubstr("colours (RGB)"));
  EXPECT_THAT(fault(with_type(32)), HasSubstr("complex"));
  EXPECT_THAT(fault(with_type(77)), HasSubstr("unknown type of samples: 77"));
  EXPECT_THAT(fault(with_sizes({3, 2, 2, 5})), HasSubstr("a series of 5 grids"));
  EXPECT_THAT(fault(with_sizes({3, 2, 2, 1, 3})), HasSubstr("3 components"));
  EXPECT_THAT(fault(with_sizes({3, -2, 2})), HasSubstr("negative"));
  EXPECT_THAT(fault(with_sizes({3, 0, 2})), HasSubstr("a size is 0"));
  EXPECT_THAT(fault(with_sizes({3, 2, 3})), HasSubstr("truncated"));
  EXPECT_THAT(fault(with_sizes({32767, 32767, 32767})), HasSubstr("truncated"));
  EXPECT_THAT(fault(with_sizes({})), HasSubstr("0 dimensions"));
}

TEST(NiftiTest, SizesOfVersionTwoThatOverflowAreFound) {
  const model::TestFolder folder;
  NiftiSettings settings;
  settings.version = 2;
  settings.sizes = {int64_t{1} << 40, int64_t{1} << 20, 16};
  EXPECT_THAT(fault_of(write(folder / "grid.nii", nifti_header(settings) + ramp_bytes())), HasSubstr("overflow"));
}

TEST(NiftiTest, APositionThatIsNotFiniteIsRefused) {
  const model::TestFolder folder;
  NiftiSettings settings;
  settings.sform = 1;
  settings.rows = {1, 0, 0, std::nan(""), 0, 1, 0, 0, 0, 0, 1, 0};
  EXPECT_THAT(fault_of(write(folder / "a.nii", nifti_header(settings) + ramp_bytes())), HasSubstr("not finite"));
  settings.rows = std::vector<double>(12);
  EXPECT_THAT(fault_of(write(folder / "b.nii", nifti_header(settings) + ramp_bytes())), HasSubstr("do not span"));
}

}  // namespace
}  // namespace surfcast::grid
