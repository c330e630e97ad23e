#include "residency/packing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "model/quantize.h"

namespace surfcast::residency {
namespace {

/// A surfel unpacked in double precision, according to the documented layout.
struct Unpacked {
  glm::dvec3 position;  // world
  glm::u16vec2 normal;
  double radius;
  double weight;
  glm::uvec3 color;
};

/// The index of surfel `i` of the block itself, not of a surfel that it was merged to.
size_t place_of(const PackedSurfels& block, size_t i) {
  for (const PackedRun& run : block.runs) {
    for (uint32_t k = run.first; run.finest && k < run.first + run.count; ++k) {
      if (block.representatives[k] == i) return k;
    }
  }
  ADD_FAILURE() << "surfel " << i << " is missing";
  return 0;
}

Unpacked unpacked(const PackedSurfels& block, size_t i) {
  const glm::uvec4 s = block.surfels[place_of(block, i)];
  const auto size = [](const LogScale& scale, uint32_t code) {
    return std::exp2(scale.log2_largest - scale.octaves * code / 1023);
  };
  const glm::dvec3 steps(s.x & 0xfffff, s.y & 0xfffff, s.z & 0xfffff);
  return {block.lattice.position(glm::uvec3(steps)), glm::u16vec2(s.x >> 20, s.y >> 20),
          size(block.radius, (s.z >> 20) & 1023), size(block.weight, ((s.z >> 30) << 8) | (s.w >> 24)),
          glm::uvec3(s.w & 255, (s.w >> 8) & 255, (s.w >> 16) & 255)};
}

model::DecodedBlock block_of(size_t surfels, int32_t extent, std::mt19937& random) {
  std::uniform_int_distribution<int32_t> index(0, extent);
  std::uniform_int_distribution<uint16_t> code(0, static_cast<uint16_t>(model::kSourcePrecision.max_normal_code()));
  std::uniform_real_distribution<float> octaves(-8, 0);
  model::DecodedBlock block;
  block.grid = {glm::dvec3(0.001, 0.002, 0.004), glm::dvec3(448262.31, 5411932.67, 312.45)};
  block.origin = {-5, 17, 1000000};
  for (size_t i = 0; i < surfels; ++i) {
    block.indices.emplace_back(index(random), index(random), index(random));
    block.normals.push_back(
        model::decode_normal({code(random), code(random)}, model::kSourcePrecision.octahedral_half));
    block.radii.push_back(std::exp2(octaves(random) / 8));
    block.weights.push_back(std::exp2(octaves(random)));
    block.colors.emplace_back(random() % 256, random() % 256, random() % 256);
  }
  block.indices.front() = glm::ivec3(extent);
  return block;
}

TEST(PackBlock, WhatFitsTwentyBitsIsExact) {
  std::mt19937 random(1);
  for (const int extent : {0, 1, 1000, (1 << 20) - 1}) {
    const model::DecodedBlock block = block_of(200, extent, random);
    const PackedSurfels packed = pack_block(block, 8, true);
    for (size_t i = 0; i < block.size(); ++i) {
      EXPECT_LT(glm::distance(unpacked(packed, i).position, block.position(i)), 1e-8) << extent;
    }
  }
}

TEST(PackBlock, LongerLatticesAreRoundedToAMillionthOfTheirExtent) {
  std::mt19937 random(2);
  for (const int extent : {1 << 20, (1 << 21) - 1, 12345678, (1 << 30) - 1}) {
    const model::DecodedBlock block = block_of(200, extent, random);
    const PackedSurfels packed = pack_block(block, 8, true);
    const glm::dvec3 tolerance = 1.01 * block.grid.scale * static_cast<double>(extent) / double{1 << 20};
    for (size_t i = 0; i < block.size(); ++i) {
      const glm::dvec3 d = glm::abs(unpacked(packed, i).position - block.position(i));
      EXPECT_TRUE(d.x <= tolerance.x && d.y <= tolerance.y && d.z <= tolerance.z) << extent;
    }
  }
}

TEST(PackBlock, NormalsAndColorsOfEightBitsComeBackAsTheFileHasThem) {
  std::mt19937 random(3);
  const model::DecodedBlock block = block_of(2000, 1000, random);
  const PackedSurfels packed = pack_block(block, 8, true);
  for (size_t i = 0; i < block.size(); ++i) {
    const Unpacked s = unpacked(packed, i);
    EXPECT_LT(glm::distance(model::decode_normal(s.normal, model::kSourcePrecision.octahedral_half), block.normals[i]),
              1e-6F);
    EXPECT_EQ(s.color, glm::uvec3(block.colors[i]));
  }
}

TEST(PackBlock, ColorsOfSixteenBitsAreRounded) {
  std::mt19937 random(4);
  model::DecodedBlock block = block_of(3, 10, random);
  block.colors = {{0, 65535, 257 * 128}, {128, 129, 257}, {65535 - 128, 65535 - 129, 300}};
  const PackedSurfels packed = pack_block(block, 16, true);
  EXPECT_EQ(unpacked(packed, 0).color, glm::uvec3(0, 255, 128));
  EXPECT_EQ(unpacked(packed, 1).color, glm::uvec3(0, 1, 1));
  EXPECT_EQ(unpacked(packed, 2).color, glm::uvec3(255, 254, 1));
}

TEST(PackBlock, SizesAreWithinAHalfStepOfTheBlocksOwnScale) {
  std::mt19937 random(5);
  const model::DecodedBlock block = block_of(2000, 1000, random);
  const PackedSurfels packed = pack_block(block, 8, true);
  for (size_t i = 0; i < block.size(); ++i) {
    const Unpacked s = unpacked(packed, i);
    EXPECT_NEAR(s.radius / static_cast<double>(block.radii[i]), 1, 0.0009)
        << "at most two and a half octaves, with what is merged";
    EXPECT_NEAR(s.weight / static_cast<double>(block.weights[i]), 1, 0.003) << "eight octaves in the block";
  }
}

TEST(PackBlock, OneSizeIsExactAndAVanishingOneHoldsBackNoOther) {
  std::mt19937 random(6);
  model::DecodedBlock block = block_of(100, 1000, random);
  block.radii.assign(100, 0.0123F);
  block.weights.assign(100, 0.5F);
  block.weights[7] = 1e-30F;
  const PackedSurfels packed = pack_block(block, 8, true);
  EXPECT_NEAR(unpacked(packed, 3).radius, 0.0123, 1e-9);
  EXPECT_NEAR(unpacked(packed, 3).weight, 0.5, 1e-9);
  EXPECT_NEAR(unpacked(packed, 7).weight, 0.5 * std::exp2(-32), 1e-12);
}

TEST(PackBlock, WithoutColorsTheSurfelIsPackedAllTheSame) {
  std::mt19937 random(7);
  model::DecodedBlock block = block_of(10, 1000, random);
  block.colors.clear();
  const PackedSurfels packed = pack_block(block, 0, true);
  for (size_t i = 0; i < block.size(); ++i) EXPECT_EQ(unpacked(packed, i).color, glm::uvec3(0));
  EXPECT_EQ(packed.surfels.size() * sizeof(glm::uvec4), 160U);
}

TEST(LinearRootTable, EveryLevelComesBackWithinAQuarterOfALevelOrSoInTenBits) {
  const std::vector<uint32_t> table = linear_root_table();
  ASSERT_EQ(table.size(), 256u);
  const auto level_of = [](double root) {
    const double l = root * root;
    return 255 * (l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055);
  };
  for (int level = 0; level < 256; ++level) {
    EXPECT_NEAR(level_of((table[level] & 2047) / 2047.0), level, 0.25);
    EXPECT_NEAR(level_of((table[level] >> 16) / 1023.0), level, 0.45);
  }
}

TEST(PackBlock, OutliersAreDrawnNoLargerThanThat) {
  std::mt19937 random(8);
  model::DecodedBlock block = block_of(100, 1000, random);
  block.radii.assign(100, 0.01F);
  block.radii[7] = 1;
  EXPECT_NEAR(unpacked(pack_block(block, 8, true), 7).radius, 0.04, 1e-8);
}

TEST(PackBlock, WhatIsMergedShowsTheAttributesOfOneOfItsOwn) {
  std::mt19937 random(9);
  model::DecodedBlock block = block_of(2000, 1000, random);
  std::vector<uint8_t> classes(block.size());
  for (uint8_t& code : classes) code = static_cast<uint8_t>(random() % 200);
  block.scalars.push_back({"classification", classes});
  PackedSurfels packed = pack_block(block, 8, true);
  pack_attributes(block, packed);
  ASSERT_GT(packed.surfels.size(), block.size()) << "some are merged";
  ASSERT_EQ(packed.attributes.size(), packed.surfels.size());
  for (size_t i = 0; i < packed.surfels.size(); ++i) {
    EXPECT_EQ((packed.attributes[i] >> 16) & 255, classes[packed.representatives[i]]);
  }
}

TEST(PackBlock, OpacitiesAreThoseOfTheFileOrFull) {
  std::mt19937 random(9);
  model::DecodedBlock block = block_of(3, 1000, random);
  PackedSurfels without = pack_block(block, 8, true);
  pack_attributes(block, without);
  for (const uint32_t word : without.attributes) EXPECT_EQ(word >> 24, 255U);
  block.scalars.push_back({"alpha", std::vector<float>{0, 0.2F, std::nanf("")}});
  PackedSurfels packed = pack_block(block, 8, true);
  pack_attributes(block, packed);
  constexpr std::array kOpacities{0U, 51U, 255U};
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(packed.attributes[i] >> 24, kOpacities.at(packed.representatives[i]));
}

TEST(PackBlock, WhatIsMergedHasTheMeanOpacity) {
  std::mt19937 random(9);
  model::DecodedBlock block = block_of(2000, 1000, random);
  block.radii.assign(block.size(), 1);
  std::vector<uint8_t> opacities(block.size());
  for (size_t i = 0; i < opacities.size(); ++i) opacities[i] = i % 2 == 0 ? 40 : 200;
  block.scalars.push_back({"alpha", opacities});
  PackedSurfels packed = pack_block(block, 8, true);
  pack_attributes(block, packed);
  size_t means = 0;
  for (const uint32_t word : packed.attributes) means += word >> 24 == 120 ? 1 : 0;
  EXPECT_GT(means, 100U) << "of one of each";
}

}  // namespace
}  // namespace surfcast::residency
