// The passes of a region: which of them draws into the picture, what each reads and writes, and what is cleared.

#include "render/compose_region.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

using Passes = std::vector<const RegionPass*>;

const RegionPass* pass_of(kinds::DrawnAs drawn_as) {
  const auto found = std::ranges::find(region_passes(), drawn_as, &RegionPass::draws);
  return found == region_passes().end() ? nullptr : *found;
}

/// All sets of passes with one pass at least.
std::vector<Passes> all_sets() {
  std::vector<Passes> sets;
  for (unsigned bits = 1; bits < 1U << region_passes().size(); ++bits) {
    Passes set;
    for (size_t i = 0; i < region_passes().size(); ++i) {
      if ((bits >> i & 1U) != 0) set.push_back(region_passes()[i]);
    }
    sets.push_back(std::move(set));
  }
  return sets;
}

/// A plan in one line: for each pass what it reads > what it writes, and what is cleared before in brackets.
std::string described(const std::vector<PlannedPass>& plan) {
  constexpr const char* kPlaces[] = {"nothing", "surfaces", "codes", "picture"};
  const auto name = [&](Place place) { return kPlaces[static_cast<size_t>(place)]; };
  std::string text;
  for (const PlannedPass& planned : plan) {
    if (!text.empty()) text += ", ";
    for (const Place place : planned.cleared) text += std::string("[") + name(place) + "] ";
    text += std::string(name(planned.places.reads)) + " > " + name(planned.places.writes);
  }
  return text;
}

std::string plan_of(const std::vector<kinds::DrawnAs>& drawn) {
  Passes passes;
  for (const kinds::DrawnAs drawn_as : drawn) passes.push_back(pass_of(drawn_as));
  return described(plan_passes(passes));
}

TEST(RegionPasses, ThereIsOneForEachWayOfDrawing) {
  std::set<kinds::DrawnAs> ways;
  for (const RegionPass* pass : region_passes()) {
    EXPECT_TRUE(ways.insert(pass->draws).second);
    EXPECT_NE(pass->draw, nullptr);
  }
  using enum kinds::DrawnAs;
  EXPECT_EQ(ways, (std::set{kSurface, kGaussians, kGlyphs, kVolume}));
}

TEST(RegionPasses, AllReadWhatHasBeenDrawnOrClearedAndTheLastOneWritesThePicture) {
  for (const Passes& set : all_sets()) {
    const std::vector<PlannedPass> plan = plan_passes(set);
    ASSERT_EQ(plan.size(), set.size());
    std::set<Place> ready{Place::kNowhere};
    Place drawn = Place::kNowhere;
    for (const PlannedPass& planned : plan) {
      for (const Place place : planned.cleared) EXPECT_TRUE(ready.insert(place).second) << described(plan);
      EXPECT_TRUE(ready.contains(planned.places.reads)) << described(plan);
      EXPECT_TRUE(drawn == Place::kNowhere || planned.places.reads == drawn) << described(plan);
      EXPECT_EQ(planned.places.writes == Place::kPicture, &planned == &plan.back()) << described(plan);
      drawn = planned.places.writes;
    }
  }
}

TEST(RegionPasses, AKindAloneHasNoLayers) {
  for (const RegionPass* pass : region_passes()) {
    EXPECT_EQ(described(plan_passes(Passes{pass})), "nothing > picture");
  }
}

TEST(RegionPasses, OthersDrawBetweenTheLayersOfSurfaces) {
  using enum kinds::DrawnAs;
  for (const kinds::DrawnAs other : {kGlyphs, kGaussians, kVolume}) {
    EXPECT_EQ(plan_of({kSurface, other}), "[surfaces] nothing > surfaces, surfaces > picture");
  }
  EXPECT_EQ(plan_of({kSurface, kGlyphs, kVolume}),
            "[surfaces] nothing > surfaces, surfaces > surfaces, surfaces > picture");
}

TEST(RegionPasses, EllipsoidsAreAddedToLayersWithoutSurfaces) {
  using enum kinds::DrawnAs;
  EXPECT_EQ(plan_of({kGlyphs, kVolume}), "[surfaces] surfaces > surfaces, surfaces > picture");
  EXPECT_EQ(plan_of({kGlyphs, kGaussians}), "[surfaces] surfaces > surfaces, surfaces > picture");
}

TEST(RegionPasses, VolumesDrawBetweenCodesAmongGaussians) {
  using enum kinds::DrawnAs;
  EXPECT_EQ(plan_of({kGaussians, kVolume}), "[surfaces] [codes] surfaces > codes, codes > picture");
  EXPECT_EQ(plan_of({kSurface, kGlyphs, kGaussians, kVolume}),
            "[surfaces] nothing > surfaces, surfaces > surfaces, [codes] surfaces > codes, codes > picture");
}

}  // namespace
}  // namespace surfcast::render
