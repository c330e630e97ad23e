#include "render/display_options.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "render/color_maps.h"

namespace surfcast::render {
namespace {

glm::ivec3 levels(const glm::dvec3& color) {
  return glm::ivec3(glm::round(color * 255.0));
}

TEST(ColorMaps, EndsAreExact) {
  EXPECT_EQ(levels(map_color(picture::ColorMap::kViridis, 0)), glm::ivec3(0x44, 0x01, 0x54));
  EXPECT_EQ(levels(map_color(picture::ColorMap::kViridis, 1)), glm::ivec3(0xfd, 0xe7, 0x25));
  EXPECT_EQ(levels(map_color(picture::ColorMap::kTurbo, 0)), glm::ivec3(0x30, 0x12, 0x3b));
  EXPECT_EQ(levels(map_color(picture::ColorMap::kTurbo, 1)), glm::ivec3(0x7a, 0x04, 0x03));
  EXPECT_EQ(map_color(picture::ColorMap::kGray, 0), glm::dvec3(0));
  EXPECT_EQ(map_color(picture::ColorMap::kGray, 1), glm::dvec3(1));
  for (const picture::ColorMap map : {picture::ColorMap::kViridis, picture::ColorMap::kTurbo, picture::ColorMap::kGray,
                                      picture::ColorMap::kTerrain}) {
    EXPECT_EQ(map_color(map, -3), map_color(map, 0));
    EXPECT_EQ(map_color(map, 7), map_color(map, 1));
    EXPECT_EQ(map_color_table(map).size(), kMapEntries);
  }
}

TEST(ColorMaps, GrayIsProportionalAndViridisGrowsLighter) {
  double last = -1;
  for (double t = 0; t <= 1; t += 1.0 / 64) {
    EXPECT_NEAR(map_color(picture::ColorMap::kGray, t).g, t, 1e-12);
    const glm::dvec3 c = map_color(picture::ColorMap::kViridis, t);
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

model::ModelInfo survey() {
  model::ModelInfo info;
  info.bounds.include(glm::dvec3(0, 0, 10));
  info.bounds.include(glm::dvec3(5, 7, 30));
  info.elevation = {12, 28};
  info.scalar_names = {"intensity", "classification"};
  info.ranges = {{"intensity", 0, 60000, 100, 4000}};
  return info;
}

TEST(DisplayOptions, WithoutOptionsNothingIsNeeded) {
  const Result<DisplayOptions> display = resolve_display_options(survey(), {});
  ASSERT_TRUE(display);
  EXPECT_FALSE(display->attributes || display->clipped || display->hides_classes || display->mapped());
}

TEST(DisplayOptions, RangesAreTheModelsUnlessGiven) {
  picture::PictureRequest request;
  request.coloring.source = picture::SurfelColor::kElevation;
  EXPECT_EQ(resolve_display_options(survey(), request)->first, 12) << "outliers do not set the range";
  EXPECT_EQ(resolve_display_options(survey(), request)->last, 28);
  EXPECT_FALSE(resolve_display_options(survey(), request)->attributes) << "heights are in the positions";
  request.coloring.source = picture::SurfelColor::kIntensity;
  request.coloring.last = 9;
  EXPECT_EQ(resolve_display_options(survey(), request)->first, 100) << "outliers do not set the range";
  EXPECT_EQ(resolve_display_options(survey(), request)->last, 9);
  EXPECT_TRUE(resolve_display_options(survey(), request)->attributes);
}

TEST(DisplayOptions, StepsThroughVolumesAreLongerInMotionOnly) {
  picture::PictureRequest request;
  request.spacing = 2;
  EXPECT_EQ(resolve_display_options(survey(), request)->volumes.step, 1);
  request.rest_spacing = 0;
  EXPECT_EQ(resolve_display_options(survey(), request)->volumes.step, 2);
  request.spacing = 0.5;
  EXPECT_EQ(resolve_display_options(survey(), request)->volumes.step, 1);
  request.spacing = 100;
  EXPECT_EQ(resolve_display_options(survey(), request)->volumes.step, 2);
}

TEST(DisplayOptions, WhatAModelLacksCannotBeShownAndNeedNotBeHidden) {
  picture::PictureRequest request;
  request.hidden_classes.set(2);
  EXPECT_FALSE(resolve_display_options({}, request)->hides_classes);
  EXPECT_FALSE(resolve_display_options({}, request)->attributes);
  EXPECT_TRUE(resolve_display_options(survey(), request)->hides_classes);
  for (const picture::SurfelColor source : {picture::SurfelColor::kIntensity, picture::SurfelColor::kClassification}) {
    request.coloring.source = source;
    EXPECT_EQ(resolve_display_options({}, request).error().kind, ErrorKind::kInvalidInput);
  }
}

TEST(DisplayOptions, OpacitiesOfTheScanCountIfSomeAreBelowOneAndSomeAboveZero) {
  const auto counts = [](double least, double most) {
    model::ModelInfo info = survey();
    info.scalar_names.emplace_back("alpha");
    info.ranges.push_back({"alpha", least, most, least, most});
    const SeenThrough through = seen_through(info, {});
    EXPECT_EQ(through.any, through.by_file);
    return through.by_file;
  };
  EXPECT_TRUE(counts(128, 128));
  EXPECT_TRUE(counts(0, 255));
  EXPECT_TRUE(counts(0.2, 1));
  EXPECT_TRUE(counts(1000, 65535));
  EXPECT_FALSE(counts(255, 255));
  EXPECT_FALSE(counts(1, 1));
  EXPECT_FALSE(counts(0, 0)) << "of writers that do not know opacities";
  EXPECT_FALSE(seen_through(survey(), {}).any);
}

TEST(DisplayOptions, HiddenClassesAreBitsByCode) {
  picture::PictureRequest request;
  for (const size_t code : {0, 31, 32, 127, 128, 255}) request.hidden_classes.set(code);
  const layout::DisplayConstants constants = display_constants(DisplayOptions{}, request);
  for (size_t code = 0; code < 256; ++code) {
    const uint32_t word = constants.hidden[code / 128][static_cast<int>(code % 128 / 32)];
    EXPECT_EQ((word >> (code % 32)) & 1, request.hidden_classes[code] ? 1U : 0U) << code;
  }
}

/// A block of survey data in UTM coordinates with centimetres, which are not exact in double precision.
residency::ResidentBlock utm_block() {
  residency::ResidentBlock block;
  block.lattice = {{{0.01, 0.01, 0.01}, {400000, 5000000, 0}}, {4826231, 41193267, 31245}, {0, 0, 0}, {999, 999, 99}};
  return block;
}

/// Whether the shader shows a code with these clip ranges.
bool shown(const layout::BlockDisplay& display, const std::vector<layout::ClipRange>& ranges, const glm::uvec3& code) {
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
  return !(display.clips.y > 0 && !in_any(display.clips.x, display.clips.y)) &&
         !in_any(display.clips.x + display.clips.y, display.clips.z);
}

void expect_same_as_clip(const geometry::Clip& clip) {
  const residency::ResidentBlock block = utm_block();
  DisplayOptions display;
  display.clipped = true;
  std::vector<layout::ClipRange> ranges(5);  // those of other blocks
  const layout::BlockDisplay answer = block_display(display, clip, block, ranges);
  for (uint32_t x = 0; x < 1000; ++x) {
    for (const uint32_t z : {0U, 17U, 50U, 51U, 99U}) {
      const glm::uvec3 code(x, (x * 7) % 1000, z);
      ASSERT_EQ(shown(answer, ranges, code), clip.shows(block.lattice.position(code))) << x << ' ' << z;
    }
  }
}

TEST(DisplayOptions, ClipBoxesCutAtEveryPointOfAUtmLatticeExactly) {
  const residency::ResidentBlock block = utm_block();
  const auto at = [&](uint32_t x, uint32_t y, uint32_t z) { return block.lattice.position({x, y, z}); };
  // Faces exactly on points, one bit beside them, and between them.
  const glm::dvec3 low = at(100, 0, 17);
  const glm::dvec3 high = at(700, 999, 50);
  const double above = std::nextafter(low.x, 1e9);
  const double below = std::nextafter(high.x, 0);
  for (const geometry::Box& box : {geometry::Box{low, high}, geometry::Box{{above, low.y, low.z}, high},
                                   geometry::Box{low, {below, high.y, high.z}},
                                   geometry::Box{low + 0.004, high - 0.003}, geometry::Box{low, low}}) {
    expect_same_as_clip({{box}, {}});
    expect_same_as_clip({{}, {box}});
    expect_same_as_clip({{box, {at(0, 0, 0), at(50, 999, 99)}}, {{at(20, 0, 0), at(30, 999, 99)}, box}});
  }
}

TEST(DisplayOptions, ABlockOutsideOfAllBoxesShowsNothingAndOneWithinAsksNothing) {
  const residency::ResidentBlock block = utm_block();
  DisplayOptions display;
  display.clipped = true;
  std::vector<layout::ClipRange> ranges;
  const glm::dvec3 first = block.lattice.position({0, 0, 0});
  const layout::BlockDisplay out = block_display(display, {{{first - 9.0, first - 1.0}}, {}}, block, ranges);
  EXPECT_FALSE(shown(out, ranges, {0, 0, 0}));
  // There is no code between two lattice points either.
  const layout::BlockDisplay between = block_display(display, {{{first + 0.002, first + 0.008}}, {}}, block, ranges);
  EXPECT_FALSE(shown(between, ranges, {0, 0, 0}) || shown(between, ranges, {1, 1, 1}));
  ranges.clear();
  const layout::BlockDisplay in = block_display(display, {{{first - 1.0, first + 1000.0}}, {}}, block, ranges);
  EXPECT_EQ(in.clips.y + in.clips.z, 0);
  EXPECT_TRUE(ranges.empty());
}

TEST(DisplayOptions, RampsStayFiniteWhateverTheRange) {
  DisplayOptions display;
  display.color = picture::SurfelColor::kElevation;
  std::vector<layout::ClipRange> ranges;
  for (const auto& [first, last] : {std::pair(0.0, 1.0), {312.45, 312.45}, {-1e300, 1e300}, {5.0, -5.0}}) {
    display.first = first;
    display.last = last;
    const layout::BlockDisplay answer = block_display(display, {}, utm_block(), ranges);
    EXPECT_TRUE(std::isfinite(answer.ramp.x) && std::isfinite(answer.ramp.y));
  }
  display.first = 312.45;
  display.last = 313.44;
  const layout::BlockDisplay answer = block_display(display, {}, utm_block(), ranges);
  EXPECT_NEAR(answer.ramp.x, 0, 1e-6);
  EXPECT_NEAR(answer.ramp.x + 99 * answer.ramp.y, 1, 1e-5);
}

}  // namespace
}  // namespace surfcast::render
