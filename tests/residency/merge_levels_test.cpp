#include "residency/merge_levels.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <set>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "geometry/morton.h"
#include "shared/frame_layout.h"
#include "surfel/even_sampling.h"

namespace surfcast::residency {
namespace {

constexpr auto kGridRadius = static_cast<float>(surfel::kGridRadiusOverSpacing);  // of a grid of spacing 1

/// A square of side * side surfels at distance 1, in Morton order.
std::vector<MergedSurfel> sheet(uint32_t side) {
  std::vector<MergedSurfel> surfels;
  for (uint32_t i = 0; i < side * side; ++i) {
    uint32_t x = 0;
    uint32_t y = 0;
    for (uint32_t b = 0; b < 16; ++b) {
      x |= ((i >> (2 * b)) & 1) << b;
      y |= ((i >> (2 * b + 1)) & 1) << b;
    }
    surfels.push_back({{x, y, 0}, {0, 0, 1}, kGridRadius, 0.25F, glm::vec3(static_cast<float>(x % 2)), i});
  }
  return surfels;
}

/// Implements the rule of shaders/include/spacing.glsl.
bool drawn(const SurfelSequence& sequence, const PackedRun& run, uint32_t i, float wanted) {
  const float radius = sequence.surfels[i].radius;
  const float merged = run.pairs ? std::hypot(radius, sequence.surfels[i ^ 1].radius) : radius;
  return (run.finest || radius <= wanted) && (run.coarsest || merged > SURFCAST_SPACING_SLACK * wanted);
}

std::vector<MergedSurfel> drawn(const SurfelSequence& sequence, float wanted) {
  std::vector<MergedSurfel> surfels;
  for (const PackedRun& run : sequence.runs) {
    for (uint32_t i = run.first; i < run.first + run.count; ++i) {
      if (drawn(sequence, run, i, wanted)) surfels.push_back(sequence.surfels[i]);
    }
  }
  return surfels;
}

double area(const std::vector<MergedSurfel>& surfels) {
  double sum = 0;
  for (const MergedSurfel& s : surfels) sum += double{s.radius} * double{s.radius};
  return sum;
}

std::vector<MergedSurfel> noise(size_t count, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(0, 40);
  std::normal_distribution<float> part;
  std::vector<std::pair<uint64_t, MergedSurfel>> sorted;
  for (uint32_t i = 0; i < count; ++i) {
    // Filled backwards one by one: compilers evaluate arguments in different orders.
    glm::dvec3 p;
    glm::vec3 n;
    for (const int axis : {2, 1, 0}) p[axis] = (axis == 2 ? 0.1 : 1) * at(random);
    for (const int axis : {2, 1, 0}) n[axis] = part(random) + (axis == 2 ? 1 : 0);
    n = glm::normalize(n);
    sorted.push_back(
        {geometry::interleave(glm::u32vec3(p * 100.0)), {p, n, 0.5F + 0.1F * static_cast<float>(i % 10), 1, {}, i}});
  }
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<MergedSurfel> surfels;
  for (const auto& [code, surfel] : sorted) surfels.push_back(surfel);
  return surfels;
}

TEST(MergeSurfels, TwoNeighboursBecomeTheirMeanAndKeepTheirAreaAndWeight) {
  const std::vector<MergedSurfel> two{{{0, 0, 0}, {0, 0, 1}, 1, 0.5F, glm::vec3(0), 7},
                                      {{1, 0, 0}, {0, 0, 1}, 2, 0.3F, glm::vec3(1), 9}};
  const MergedLevel level = merge_surfels(two, true);
  ASSERT_EQ(level.surfels.size(), 1u);
  const MergedSurfel& m = level.surfels.front();
  EXPECT_NEAR(m.position.x, 0.8, 1e-6) << "by area: 1 to 4";
  EXPECT_NEAR(m.radius, std::sqrt(5.0), 1e-6);
  EXPECT_NEAR(m.weight, 0.34, 1e-6);
  EXPECT_NEAR(m.light.r, 0.8, 1e-6);
  EXPECT_EQ(m.representative, 9u) << "the larger one";
}

TEST(MergeSurfels, OpacitiesAreAveragedAndLightByThemToo) {
  const std::vector<MergedSurfel> two{{{0, 0, 0}, {0, 0, 1}, 1, 1, glm::vec3(0), 0, false, 0.2F},
                                      {{1, 0, 0}, {0, 0, 1}, 2, 1, glm::vec3(1), 1, false, 0.8F}};
  const MergedLevel level = merge_surfels(two, true);
  ASSERT_EQ(level.surfels.size(), 1u);
  EXPECT_NEAR(level.surfels.front().opacity, 0.68, 1e-6) << "by area: 1 to 4";
  EXPECT_NEAR(level.surfels.front().light.r, 3.2 / 3.4, 1e-6) << "by area times opacity";
}

TEST(MergeSurfels, WhatIsNotSeenKeepsItsMeanLight) {
  const std::vector<MergedSurfel> two{{{0, 0, 0}, {0, 0, 1}, 1, 1, glm::vec3(0), 0, false, 0},
                                      {{1, 0, 0}, {0, 0, 1}, 1, 1, glm::vec3(1), 1, false, 0}};
  const MergedSurfel merged = merge_surfels(two, true).surfels.at(0);
  EXPECT_EQ(merged.opacity, 0);
  EXPECT_NEAR(merged.light.r, 0.5, 1e-6);
}

TEST(MergeSurfels, TheTwoSidesOfASheetStayApartUnlessThereAreNoSides) {
  const std::vector<MergedSurfel> two{{{0, 0, 0}, {0, 0, 1}, 1, 1, glm::vec3(0), 0},
                                      {{0, 0, 0.1}, {0, 0, -1}, 1, 1, glm::vec3(0), 1}};
  EXPECT_EQ(merge_surfels(two, true).surfels.size(), 2u);
  const MergedLevel merged = merge_surfels(two, false);
  ASSERT_EQ(merged.surfels.size(), 1u);
  EXPECT_NEAR(std::abs(merged.surfels.front().normal.z), 1, 1e-6) << "the sides do not cancel";
}

TEST(MergeSurfels, WhatIsFarApartStaysApart) {
  const std::vector<MergedSurfel> two{{{0, 0, 0}, {0, 0, 1}, 1, 1, glm::vec3(0), 0},
                                      {{2.01, 0, 0}, {0, 0, 1}, 1, 1, glm::vec3(0), 1}};
  EXPECT_EQ(merge_surfels(two, true).surfels.size(), 2u);
}

TEST(MergeLevels, OnASheetEachLevelHasHalfTheSurfelsAndFourAreAGridAgain) {
  const SurfelSequence sequence = merge_levels(sheet(64), true);
  EXPECT_EQ(drawn(sequence, 0).size(), 4096u);
  EXPECT_EQ(drawn(sequence, 1.5F * kGridRadius).size(), 2048u);
  const std::vector<MergedSurfel> quarter = drawn(sequence, 2.1F * kGridRadius);
  ASSERT_EQ(quarter.size(), 1024u);
  for (const MergedSurfel& s : quarter) {
    EXPECT_NEAR(std::fmod(s.position.x, 2), 0.5, 1e-6);
    EXPECT_NEAR(std::fmod(s.position.y, 2), 0.5, 1e-6);
    EXPECT_NEAR(s.light.r, 0.5, 1e-6) << "stripes of 0 and 1";
  }
}

TEST(MergeLevels, AtAnySpacingTheSameAreaIsDrawnOnce) {
  for (const std::vector<MergedSurfel>& surfels : {sheet(64), noise(5000, 1), noise(300, 2)}) {
    const SurfelSequence sequence = merge_levels(surfels, true);
    for (float wanted = 0.01F; wanted < 10; wanted *= 1.37F) {
      // Within a band of 1 %, both a merged surfel and its pair are drawn.
      EXPECT_NEAR(area(drawn(sequence, wanted)) / area(surfels), 1, 0.05) << wanted;
      EXPECT_GE(area(drawn(sequence, wanted)), 0.9999 * area(surfels)) << wanted;
    }
  }
}

TEST(MergeLevels, AtSpacingZeroEverySurfelIsDrawnAsItIs) {
  const std::vector<MergedSurfel> surfels = noise(3000, 3);
  std::set<uint32_t> seen;
  for (const MergedSurfel& s : drawn(merge_levels(surfels, true), 0)) seen.insert(s.representative);
  EXPECT_EQ(seen.size(), surfels.size());
}

TEST(MergeLevels, NothingCoarserThanWantedIsDrawnButWhatTheBlockHas) {
  const std::vector<MergedSurfel> surfels = noise(5000, 4);
  float largest = 0;
  for (const MergedSurfel& s : surfels) largest = std::max(largest, s.radius);
  const SurfelSequence sequence = merge_levels(surfels, true);
  for (float wanted = 0.1F; wanted < 5; wanted *= 1.5F) {
    for (const MergedSurfel& s : drawn(sequence, wanted)) EXPECT_LE(s.radius, std::max(wanted, largest));
  }
}

TEST(MergeLevels, ASequenceHasAtMostTwiceTheSurfelsAndItsPairsBeginAtEvenPlaces) {
  for (const size_t count : {size_t{1}, size_t{2}, size_t{255}, size_t{256}, size_t{1000}, size_t{16384}}) {
    const SurfelSequence sequence = merge_levels(noise(count, 5), true);
    EXPECT_LE(sequence.surfels.size(), kMaxPackedPerSurfel * count);
    uint32_t next = 0;
    for (const PackedRun& run : sequence.runs) {
      EXPECT_EQ(run.first, next);
      EXPECT_TRUE(!run.pairs || (run.first % 2 == 0 && run.count % 2 == 0));
      EXPECT_EQ(run.chunks.size(), (run.count + SURFCAST_CHUNK - 1) / SURFCAST_CHUNK);
      next += run.count;
    }
    EXPECT_EQ(next, sequence.surfels.size());
  }
}

TEST(MergeLevels, TheRadiiOfAChunkHoldThoseOfItsSurfels) {
  const SurfelSequence sequence = merge_levels(noise(5000, 6), true);
  for (const PackedRun& run : sequence.runs) {
    for (uint32_t i = 0; i < run.count; ++i) {
      const PackedRun::Radii& radii = run.chunks[i / SURFCAST_CHUNK];
      const float own = sequence.surfels[run.first + i].radius;
      EXPECT_GE(own, radii.least);
      EXPECT_LE(run.pairs ? std::hypot(own, sequence.surfels[(run.first + i) ^ 1].radius) : own, radii.largest_merged);
    }
  }
}

/// Noise of which one surfel in three is scatter, with normals of all directions.
std::vector<MergedSurfel> mixed(size_t count) {
  std::vector<MergedSurfel> surfels = noise(count, 8);
  for (size_t i = 0; i < surfels.size(); i += 3) {
    surfels[i].scatter = true;
    surfels[i].radius *= 0.3F;
    if (i % 2 == 0) surfels[i].normal = -surfels[i].normal;
  }
  return surfels;
}

TEST(MergeSurfels, ScatterIsMergedWithScatterAloneWhateverItsNormals) {
  std::vector<MergedSurfel> two{{{0, 0, 0}, {0, 0, 1}, 1, 0.5F, glm::vec3(0), 7, true},
                                {{1, 0, 0}, {0, 0, -1}, 1, 0.5F, glm::vec3(1), 9, true}};
  const MergedLevel merged = merge_surfels(two, true);
  ASSERT_EQ(merged.surfels.size(), 1U);
  EXPECT_TRUE(merged.surfels[0].scatter);
  EXPECT_NEAR(merged.surfels[0].radius, std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(glm::length(merged.surfels[0].normal), 1, 1e-6);
  two[1].scatter = false;
  two[1].normal = {0, 0, 1};
  EXPECT_EQ(merge_surfels(two, true).surfels.size(), 2U);
}

TEST(MergeLevels, ScatterHasRunsOfItsOwn) {
  const SurfelSequence sequence = merge_levels(mixed(5000), true);
  size_t scatter = 0;
  for (const PackedRun& run : sequence.runs) {
    EXPECT_TRUE(!run.pairs || (run.first % 2 == 0 && run.count % 2 == 0));
    for (uint32_t i = run.first; i < run.first + run.count; ++i) {
      ASSERT_EQ(sequence.surfels[i].scatter, run.scatter) << i;
      scatter += run.scatter ? 1 : 0;
    }
  }
  EXPECT_GT(scatter, 5000U / 3);
}

TEST(MergeLevels, AreasOfScatterAndDiscsEachStayAtEverySpacing) {
  const std::vector<MergedSurfel> surfels = mixed(5000);
  const auto areas = [](const std::vector<MergedSurfel>& all) {
    std::vector<MergedSurfel> scatter;
    std::copy_if(all.begin(), all.end(), std::back_inserter(scatter), [](const MergedSurfel& s) { return s.scatter; });
    return std::pair(area(scatter), area(all) - area(scatter));
  };
  const SurfelSequence sequence = merge_levels(surfels, true);
  const auto expected = areas(surfels);
  for (float wanted = 0.1F; wanted < 5; wanted *= 1.5F) {
    const auto actual = areas(drawn(sequence, wanted));
    EXPECT_NEAR(actual.first / expected.first, 1, 0.05) << wanted;
    EXPECT_NEAR(actual.second / expected.second, 1, 0.05) << wanted;
  }
}

std::vector<MergedSurfel> discs_of(const std::vector<MergedSurfel>& surfels) {
  std::vector<MergedSurfel> discs;
  std::copy_if(surfels.begin(), surfels.end(), std::back_inserter(discs),
               [](const MergedSurfel& s) { return !s.scatter; });
  return discs;
}

std::vector<glm::vec3> sorted_positions(const std::vector<MergedSurfel>& surfels) {
  std::vector<glm::vec3> positions;
  for (const MergedSurfel& s : surfels) positions.push_back(s.position);
  std::sort(positions.begin(), positions.end(),
            [](const glm::vec3& a, const glm::vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  return positions;
}

TEST(MergeLevels, DiscsAreMergedAsIfThereWereNoScatterAmongThem) {
  std::vector<MergedSurfel> surfels = mixed(5000);
  for (MergedSurfel& s : surfels) s.radius *= s.scatter ? 0.01F : 1;  // too far apart to be merged
  const SurfelSequence together = merge_levels(surfels, true);
  const SurfelSequence alone = merge_levels(discs_of(surfels), true);
  for (float wanted = 0.1F; wanted < 5; wanted *= 1.5F) {
    EXPECT_EQ(sorted_positions(discs_of(drawn(together, wanted))), sorted_positions(drawn(alone, wanted))) << wanted;
  }
}

TEST(MergeLevels, WithoutScatterTheRunsAreAsBefore) {
  for (const PackedRun& run : merge_levels(noise(5000, 6), true).runs) EXPECT_FALSE(run.scatter);
}

}  // namespace
}  // namespace surfcast::residency
