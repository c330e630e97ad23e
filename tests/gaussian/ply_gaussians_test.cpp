#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gaussian/gaussian_files.h"

namespace surfcast::gaussian {
namespace {

using testing::CompressedVertex;
using testing::fault_of;
using testing::float_ply;
using testing::gaussian_properties;
using testing::gaussian_row;
using ::testing::HasSubstr;
using testing::write;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(PlyGaussiansTest, EveryDegreeIsReadWithItsCoefficientsFunctionByFunction) {
  const model::TestFolder folder;
  for (int degree = 0; degree <= 3; ++degree) {
    SCOPED_TRACE(degree);
    const auto path = write(folder / "a.ply", float_ply(gaussian_properties(degree), {gaussian_row(degree)}));
    const Result<GaussianReader> reader = GaussianReader::open(path);
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ(reader->traits().degree, degree);
    EXPECT_FALSE(reader->traits().flat);
    EXPECT_FALSE(reader->traits().antialiased);
    EXPECT_EQ(reader->traits().up, UpAxis::kMinusY);
    const Gaussians g = testing::read_whole(path);
    ASSERT_EQ(g.size(), 1u);
    EXPECT_EQ(g.positions[0], glm::dvec3(1, 2, 3));
    EXPECT_EQ(g.opacities[0], 0.5F);
    EXPECT_EQ(g.scales[0], glm::vec3(1, std::exp(-1.0F), std::exp(-2.0F)));
    EXPECT_EQ(g.rotations[0], glm::quat(0, 0.6F, 0, 0.8F));
    const size_t functions = harmonics_of(degree);
    ASSERT_EQ(g.harmonics.size(), 3 * functions);
    for (size_t channel = 0; channel < 3; ++channel) {
      EXPECT_EQ(g.harmonics[channel], 0.1F * static_cast<float>(channel + 1));
      // f_rest has all coefficients of red, then of green, then of blue; f_rest_k is k + 1.
      for (size_t j = 1; j < functions; ++j) {
        EXPECT_EQ(g.harmonics[3 * j + channel], static_cast<float>(channel * (functions - 1) + j));
      }
    }
  }
}

TEST(PlyGaussiansTest, TwoScalesAreDiscs) {
  const model::TestFolder folder;
  const auto path = write(folder / "a.ply", float_ply(gaussian_properties(1, 2), {gaussian_row(1, 2)}));
  EXPECT_TRUE(GaussianReader::open(path)->traits().flat);
  EXPECT_EQ(testing::read_whole(path).scales[0], glm::vec3(1, std::exp(-1.0F), 0));
}

TEST(PlyGaussiansTest, TextAndDoublesAreRead) {
  const model::TestFolder folder;
  std::string text = "ply\nformat ascii 1.0\nelement vertex 1\n";
  for (const std::string& name : gaussian_properties(0)) text += "property double " + name + "\n";
  text += "end_header\n5000000.25 0.1 -3 0 0 0 1 1 1 2 -1 -1 -1 1 0 0 0\n";
  const Gaussians g = testing::read_whole(write(folder / "a.ply", text));
  ASSERT_EQ(g.size(), 1u);
  EXPECT_EQ(g.positions[0], glm::dvec3(5000000.25, 0.1, -3));
}

/// The Gaussians of rows with one number replaced.
Gaussians with(const std::string& property, float value) {
  const model::TestFolder folder;
  const std::vector<std::string> names = gaussian_properties(0);
  std::vector<float> row = gaussian_row(0);
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] == property) row[i] = value;
  }
  return testing::read_whole(write(folder / "a.ply", float_ply(names, {gaussian_row(0), row, gaussian_row(0)})));
}

TEST(PlyGaussiansTest, InfiniteLogitsAreOpacitiesOfNoneAndAll) {
  EXPECT_EQ(with("opacity", kInfinity).opacities[1], 1.0F);
  EXPECT_EQ(with("opacity", -kInfinity).opacities[1], 0.0F);
  EXPECT_EQ(with("opacity", 1000).opacities[1], 1.0F);
}

TEST(PlyGaussiansTest, NumbersThatAreNotFiniteLeaveTheirGaussianOut) {
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_2", "opacity", "scale_0", "scale_2", "rot_0", "rot_3"}) {
    SCOPED_TRACE(name);
    const Gaussians g = with(name, kNan);
    EXPECT_EQ(g.size(), 2u);
    EXPECT_EQ(g.unusable, 1u);
    EXPECT_EQ(g.harmonics.size(), 6u);
  }
  for (const char* name : {"x", "f_dc_1", "scale_1", "rot_1"}) EXPECT_EQ(with(name, kInfinity).unusable, 1u) << name;
  EXPECT_EQ(with("scale_0", 89).unusable, 1u);  // exp(89) is beyond a float
}

TEST(PlyGaussiansTest, AScaleOfMinusInfinityIsFlat) {
  EXPECT_EQ(with("scale_1", -kInfinity).scales[1].y, 0.0F);
}

TEST(PlyGaussiansTest, AQuaternionOfLengthZeroIsNoRotation) {
  const model::TestFolder folder;
  std::vector<float> row = gaussian_row(0);
  std::fill(row.end() - 4, row.end(), 0.0F);
  std::vector<float> tiny = gaussian_row(0);
  std::fill(tiny.end() - 4, tiny.end(), 1e-30F);
  const Gaussians g = testing::read_whole(write(folder / "a.ply", float_ply(gaussian_properties(0), {row, tiny})));
  EXPECT_EQ(g.rotations[0], glm::quat(1, 0, 0, 0));
  EXPECT_EQ(g.rotations[1], glm::quat(0.5F, 0.5F, 0.5F, 0.5F));
}

TEST(PlyGaussiansTest, WhatIsMissingIsNamed) {
  const model::TestFolder folder;
  for (const char* name : {"z", "opacity", "scale_1", "rot_3", "f_dc_1"}) {
    std::vector<std::string> names = gaussian_properties(0);
    for (std::string& property : names) property = property == name ? "other" : property;
    EXPECT_THAT(fault_of(write(folder / "a.ply", float_ply(names, {gaussian_row(0)}))),
                HasSubstr(std::string("without the property ") + name));
  }
  std::vector<std::string> names = gaussian_properties(1);
  names[10] = "unknown";
  EXPECT_THAT(fault_of(write(folder / "a.ply", float_ply(names, {gaussian_row(1)}))), HasSubstr("1 properties f_rest"));
  EXPECT_THAT(fault_of(write(folder / "a.ply", float_ply(gaussian_properties(0), {}))), HasSubstr("has no Gaussians"));
}

TEST(PlyGaussiansTest, EveryTruncationFails) {
  const model::TestFolder folder;
  const std::string whole = float_ply(gaussian_properties(1), {gaussian_row(1), gaussian_row(1)});
  for (size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(fault_of(write(folder / "a.ply", whole.substr(0, size))), "") << size;
  }
}

const std::vector<float> kChunk = {-1, -2, -4, 1, 2, 4, -8, -8, -8, 0, 0, 0, 0, -1, 0, 1, 3, 0.5F};

TEST(CompressedPlyTest, WordsAreUnpackedWithinTheirChunk) {
  const model::TestFolder folder;
  CompressedVertex v;
  v.position = 2047U << 21 | 0U << 11 | 1023U;  // x highest, y lowest, z about the middle
  v.scale = 0U << 21 | 1023U << 11 | 0U;
  v.rotation = 2U << 30 | 1023U << 20 | 0U << 10 | 512U;  // y is left out; w, x, z follow
  v.color = 255U << 24 | 128U << 16 | 0U << 8 | 51U;
  const auto path = write(folder / "a.ply", testing::compressed_ply({kChunk}, {v}));
  const Gaussians g = testing::read_whole(path);
  ASSERT_EQ(g.size(), 1u);
  const double t = 1023.0 / 2047;
  EXPECT_EQ(g.positions[0], glm::dvec3(1, -2, static_cast<float>(-4 * (1 - t) + 4 * t)));
  EXPECT_EQ(g.scales[0], glm::vec3(std::exp(-8.0F), 1, std::exp(-8.0F)));
  const double z = (512 / 1023.0 - 0.5) * std::sqrt(2.0);
  EXPECT_NEAR(g.rotations[0].w, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(g.rotations[0].x, -std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(g.rotations[0].z, z, 1e-6);
  EXPECT_NEAR(g.harmonics[0], 0.5 / kConstantHarmonic, 1e-6);                           // red 1
  EXPECT_NEAR(g.harmonics[1], (-1 + 4 * 128 / 255.0 - 0.5) / kConstantHarmonic, 1e-5);  // green from -1 to 3
  EXPECT_NEAR(g.harmonics[2], -0.5 / kConstantHarmonic, 1e-6);                          // blue 0
  EXPECT_EQ(g.opacities[0], 0.2F);
}

TEST(CompressedPlyTest, PositionsAreRoundedToFloats) {
  const model::TestFolder folder;
  std::vector<CompressedVertex> vertices(100);
  for (uint32_t i = 0; i < 100; ++i) vertices[i].position = i * 40000007U;
  std::vector<float> chunk = kChunk;
  chunk[0] = -0.14324502646923065F;
  const Gaussians g = testing::read_whole(write(folder / "a.ply", testing::compressed_ply({chunk}, vertices)));
  for (const glm::dvec3& position : g.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      volatile float rounded = static_cast<float>(position[axis]);
      EXPECT_EQ(position[axis], static_cast<double>(rounded));
    }
  }
}

TEST(CompressedPlyTest, ChunksOf12FloatsHaveColoursFromZeroToOne) {
  const model::TestFolder folder;
  CompressedVertex v;
  v.color = 255U << 24 | 51U << 16;
  const std::vector<float> chunk(kChunk.begin(), kChunk.begin() + 12);
  const Gaussians g = testing::read_whole(write(folder / "a.ply", testing::compressed_ply({chunk}, {v})));
  EXPECT_NEAR(g.harmonics[0], 0.5 / kConstantHarmonic, 1e-6);
  EXPECT_NEAR(g.harmonics[1], -0.3 / kConstantHarmonic, 1e-6);
}

TEST(CompressedPlyTest, EveryChunkServes256Vertices) {
  const model::TestFolder folder;
  std::vector<float> second = kChunk;
  second[0] = 10;
  second[3] = 10;
  const Gaussians g = testing::read_whole(
      write(folder / "a.ply", testing::compressed_ply({kChunk, second}, std::vector<CompressedVertex>(257))));
  EXPECT_EQ(g.positions[255].x, -1);
  EXPECT_EQ(g.positions[256].x, 10);
}

TEST(CompressedPlyTest, HarmonicsAreBytesFromMinusFourToFour) {
  const model::TestFolder folder;
  CompressedVertex v;
  v.harmonics = {0, 255, 128, 127, 1, 2, 3, 4, 5};
  const Gaussians g = testing::read_whole(write(folder / "a.ply", testing::compressed_ply({kChunk}, {v})));
  ASSERT_EQ(g.harmonics.size(), 12u);
  EXPECT_EQ(g.harmonics[3], -4);                              // red of the first function
  EXPECT_EQ(g.harmonics[6], 4);                               // red of the second
  EXPECT_FLOAT_EQ(g.harmonics[9], 0.5F / 256 * 8);            // red of the third
  EXPECT_FLOAT_EQ(g.harmonics[4], -0.5F / 256 * 8);           // green of the first
  EXPECT_FLOAT_EQ(g.harmonics[11], (5.5F / 256 - 0.5F) * 8);  // blue of the third
}

TEST(CompressedPlyTest, MissingChunksAndTruncationsFail) {
  const model::TestFolder folder;
  EXPECT_THAT(fault_of(write(folder / "a.ply", testing::compressed_ply({kChunk}, std::vector<CompressedVertex>(257)))),
              HasSubstr("fewer chunks"));
  CompressedVertex v;
  v.harmonics = std::vector<uint8_t>(10);
  EXPECT_THAT(fault_of(write(folder / "a.ply", testing::compressed_ply({kChunk}, {v}))), HasSubstr("f_rest"));
  v.harmonics = std::vector<uint8_t>(9);
  const std::string whole = testing::compressed_ply({kChunk}, {v, v});
  for (size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(fault_of(write(folder / "a.ply", whole.substr(0, size))), "") << size;
  }
}

TEST(CompressedPlyTest, PackedWordsOfAnotherTypeAreRefused) {
  const model::TestFolder folder;
  std::string text = testing::compressed_ply({kChunk}, {CompressedVertex{}});
  text.replace(text.find("uint packed_scale"), 17, "float packed_scale");
  EXPECT_THAT(fault_of(write(folder / "a.ply", text)), HasSubstr("packed_scale has the wrong type"));
}

}  // namespace
}  // namespace surfcast::gaussian
