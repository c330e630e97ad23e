#include "render/look.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "render/color_maps.h"

namespace surfcast {
namespace {

glm::ivec3 levels(const glm::dvec3& color) {
  return glm::ivec3(glm::round(color * 255.0));
}

TEST(ColorMaps, EndsAreExact) {
  EXPECT_EQ(levels(map_color(ColorMap::kViridis, 0)), glm::ivec3(0x44, 0x01, 0x54));
  EXPECT_EQ(levels(map_color(ColorMap::kViridis, 1)), glm::ivec3(0xfd, 0xe7, 0x25));
  EXPECT_EQ(levels(map_color(ColorMap::kTurbo, 0)), glm::ivec3(0x30, 0x12, 0x3b));
  EXPECT_EQ(levels(map_color(ColorMap::kTurbo, 1)), glm::ivec3(0x7a, 0x04, 0x03));
  EXPECT_EQ(map_color(ColorMap::kGray, 0), glm::dvec3(0));
  EXPECT_EQ(map_color(ColorMap::kGray, 1), glm::dvec3(1));
  for (const ColorMap map : {ColorMap::kViridis, ColorMap::kTurbo, ColorMap::kGray, ColorMap::kTerrain}) {
    EXPECT_EQ(map_color(map, -3), map_color(map, 0));
    EXPECT_EQ(map_color(map, 7), map_color(map, 1));
    EXPECT_EQ(map_color_table(map).size(), kMapEntries);
  }
}

TEST(ColorMaps, GrayIsProportionalAndViridisGrowsLighter) {
  double last = -1;
  for (double t = 0; t <= 1; t += 1.0 / 64) {
    EXPECT_NEAR(map_color(ColorMap::kGray, t).g, t, 1e-12);
    const glm::dvec3 c = map_color(ColorMap::kViridis, t);
    const double lightness = 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
    EXPECT_GT(lightness, last) << t;
    last = lightness;
  }
}

TEST(ColorMaps, NeighbouringClassesDiffer) {
  for (int code = 0; code < 255; ++code) {
    const glm::ivec3 a(class_color(static_cast<uint8_t>(code)));
    const glm::ivec3 b(class_color(static_cast<uint8_t>(code + 1)));
    EXPECT_GT(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 30) << code;
  }
}

ModelInfo survey() {
  ModelInfo info;
  info.bounds.include(glm::dvec3(0, 0, 10));
  info.bounds.include(glm::dvec3(5, 7, 30));
  info.scalar_names = {"intensity", "classification"};
  info.ranges = {{"intensity", 0, 60000, 100, 4000}};
  return info;
}

TEST(Look, WithoutOptionsNothingIsNeeded) {
  const Result<Look> look = look_of(survey(), {});
  ASSERT_TRUE(look);
  EXPECT_FALSE(look->attributes || look->clipped || look->hides_classes || look->mapped());
}

TEST(Look, RangesAreTheModelsUnlessGiven) {
  PictureRequest request;
  request.coloring.source = SurfelColor::kElevation;
  EXPECT_EQ(look_of(survey(), request)->first, 10);
  EXPECT_EQ(look_of(survey(), request)->last, 30);
  EXPECT_FALSE(look_of(survey(), request)->attributes) << "heights are in the positions";
  ModelInfo y_up = survey();
  y_up.z_up = false;
  EXPECT_EQ(look_of(y_up, request)->last, 7);
  request.coloring.source = SurfelColor::kIntensity;
  request.coloring.last = 9;
  EXPECT_EQ(look_of(survey(), request)->first, 100) << "outliers do not set the range";
  EXPECT_EQ(look_of(survey(), request)->last, 9);
  EXPECT_TRUE(look_of(survey(), request)->attributes);
}

TEST(Look, WhatAModelLacksCannotBeShownAndNeedNotBeHidden) {
  PictureRequest request;
  request.hidden_classes.set(2);
  EXPECT_FALSE(look_of({}, request)->hides_classes);
  EXPECT_FALSE(look_of({}, request)->attributes);
  EXPECT_TRUE(look_of(survey(), request)->hides_classes);
  for (const SurfelColor source : {SurfelColor::kIntensity, SurfelColor::kClassification}) {
    request.coloring.source = source;
    EXPECT_EQ(look_of({}, request).error().kind, ErrorKind::kInvalidInput);
  }
}

TEST(Look, HiddenClassesAreBitsByCode) {
  PictureRequest request;
  for (const size_t code : {0, 31, 32, 127, 128, 255}) request.hidden_classes.set(code);
  const layout::LookConstants constants = look_constants(Look{}, request);
  for (size_t code = 0; code < 256; ++code) {
    const uint32_t word = constants.hidden[code / 128][static_cast<int>(code % 128 / 32)];
    EXPECT_EQ((word >> (code % 32)) & 1, request.hidden_classes[code] ? 1U : 0U) << code;
  }
}

/// A block of survey data in UTM coordinates: centimetres that no double holds exactly.
ResidentBlock utm_block() {
  ResidentBlock block;
  block.lattice = {{{0.01, 0.01, 0.01}, {400000, 5000000, 0}}, {4826231, 41193267, 31245}, {0, 0, 0}, {999, 999, 99}};
  return block;
}

/// Whether the shader would show a code, by the ranges that it gets.
bool shown(const layout::BlockLook& look, const std::vector<layout::ClipRange>& ranges, const glm::uvec3& code) {
  const auto in_any = [&](int first, int count) {
    for (int i = first; i < first + count; ++i) {
      const layout::ClipRange& range = ranges[static_cast<size_t>(i)];
      if (code.x >= range.low.x && code.y >= range.low.y && code.z >= range.low.z && code.x <= range.high.x &&
          code.y <= range.high.y && code.z <= range.high.z) {
        return true;
      }
    }
    return false;
  };
  return !(look.clips.y > 0 && !in_any(look.clips.x, look.clips.y)) &&
         !in_any(look.clips.x + look.clips.y, look.clips.z);
}

void expect_same_as_clip(const Clip& clip) {
  const ResidentBlock block = utm_block();
  Look look;
  look.clipped = true;
  std::vector<layout::ClipRange> ranges(5);  // those of other blocks
  const layout::BlockLook answer = block_look(look, clip, block, ranges);
  for (uint32_t x = 0; x < 1000; ++x) {
    for (const uint32_t z : {0U, 17U, 50U, 51U, 99U}) {
      const glm::uvec3 code(x, (x * 7) % 1000, z);
      ASSERT_EQ(shown(answer, ranges, code), clip.shows(block.lattice.position(code))) << x << ' ' << z;
    }
  }
}

TEST(Look, ClipBoxesCutAtEveryPointOfAUtmLatticeExactly) {
  const ResidentBlock block = utm_block();
  const auto at = [&](uint32_t x, uint32_t y, uint32_t z) { return block.lattice.position({x, y, z}); };
  // Faces right on points, one bit beside them, and between them.
  const glm::dvec3 low = at(100, 0, 17);
  const glm::dvec3 high = at(700, 999, 50);
  const double above = std::nextafter(low.x, 1e9);
  const double below = std::nextafter(high.x, 0);
  for (const Box& box : {Box{low, high}, Box{{above, low.y, low.z}, high}, Box{low, {below, high.y, high.z}},
                         Box{low + 0.004, high - 0.003}, Box{low, low}}) {
    expect_same_as_clip({{box}, {}});
    expect_same_as_clip({{}, {box}});
    expect_same_as_clip({{box, {at(0, 0, 0), at(50, 999, 99)}}, {{at(20, 0, 0), at(30, 999, 99)}, box}});
  }
}

TEST(Look, ABlockOutsideOfAllBoxesShowsNothingAndOneWithinAsksNothing) {
  const ResidentBlock block = utm_block();
  Look look;
  look.clipped = true;
  std::vector<layout::ClipRange> ranges;
  const glm::dvec3 first = block.lattice.position({0, 0, 0});
  const layout::BlockLook out = block_look(look, {{{first - 9.0, first - 1.0}}, {}}, block, ranges);
  EXPECT_FALSE(shown(out, ranges, {0, 0, 0}));
  // Between two lattice points lies no code either.
  const layout::BlockLook between = block_look(look, {{{first + 0.002, first + 0.008}}, {}}, block, ranges);
  EXPECT_FALSE(shown(between, ranges, {0, 0, 0}) || shown(between, ranges, {1, 1, 1}));
  ranges.clear();
  const layout::BlockLook in = block_look(look, {{{first - 1.0, first + 1000.0}}, {}}, block, ranges);
  EXPECT_EQ(in.clips.y + in.clips.z, 0);
  EXPECT_TRUE(ranges.empty());
}

TEST(Look, RampsStayFiniteWhateverTheRange) {
  Look look;
  look.color = SurfelColor::kElevation;
  std::vector<layout::ClipRange> ranges;
  for (const auto& [first, last] : {std::pair(0.0, 1.0), {312.45, 312.45}, {-1e300, 1e300}, {5.0, -5.0}}) {
    look.first = first;
    look.last = last;
    const layout::BlockLook answer = block_look(look, {}, utm_block(), ranges);
    EXPECT_TRUE(std::isfinite(answer.ramp.x) && std::isfinite(answer.ramp.y));
  }
  look.first = 312.45;
  look.last = 313.44;
  const layout::BlockLook answer = block_look(look, {}, utm_block(), ranges);
  EXPECT_NEAR(answer.ramp.x, 0, 1e-6);
  EXPECT_NEAR(answer.ramp.x + 99 * answer.ramp.y, 1, 1e-5);
}

}  // namespace
}  // namespace surfcast
