#include "builder/part_finder.h"

#include <glm/vector_relational.hpp>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::builder {
namespace {

using ::testing::ElementsAre;

/// The root cube of side 16 in eight parts: its children.
struct EightParts {
  geometry::RootCube root{glm::dvec3(0), 16};
  uint64_t points = 1000000;  ///< of each part
  PartFinder finder{children(points), root};

  static std::vector<Part> children(uint64_t points) {
    std::vector<Part> parts;
    for (uint32_t i = 0; i < 8; ++i) {
      const uint64_t side = uint64_t{1} << (3 * (geometry::kMortonDepth - 1));
      parts.push_back({{ldc::OctreeKey{}.child(i)}, i * side, (i + 1) * side, points});
    }
    return parts;
  }
  [[nodiscard]] std::vector<uint32_t> parts_of(const glm::dvec3& p) const {
    std::vector<uint32_t> found;
    finder.for_each_part(p, geometry::morton_code(root, p), [&found](uint32_t part) { found.push_back(part); });
    return found;
  }
};

TEST(PartFinderTest, APointInTheMiddleOfACellBelongsToItsPartAlone) {
  EXPECT_THAT(EightParts().parts_of({4, 4, 4}), ElementsAre(0));
  EXPECT_THAT(EightParts().parts_of({12, 4, 12}), ElementsAre(5));
}

TEST(PartFinderTest, APointNearABorderIsInTheHalosOfItsNeighbours) {
  EXPECT_THAT(EightParts().parts_of({7.6, 4, 4}), ElementsAre(0, 1));
  EXPECT_THAT(EightParts().parts_of({8.4, 4, 4}), ElementsAre(1, 0));
  EXPECT_THAT(EightParts().parts_of({7.4, 4, 4}), ElementsAre(0));
  EXPECT_EQ(EightParts().parts_of({8.1, 7.9, 8.1}).size(), 8U);
}

TEST(PartFinderTest, CellsOfFewPointsHaveHalosThatHoldTheirNeighbours) {
  const EightParts few{.points = 1000};  // ten spacings of 0.8 along a side: neighbours lie within 1.76
  EXPECT_THAT(few.parts_of({6.3, 4, 4}), ElementsAre(0, 1));
  EXPECT_THAT(few.parts_of({6.2, 4, 4}), ElementsAre(0));
}

TEST(PartFinderTest, EveryPartSeesExactlyItsGrownCells) {
  const EightParts eight;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(0, 16);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
    const std::vector<uint32_t> found = eight.parts_of(p);
    for (uint32_t part = 0; part < 8; ++part) {
      const glm::dvec3 low = glm::dvec3(part & 1, part >> 1 & 1, part >> 2) * 8.0 - 0.5;
      const bool inside = glm::all(glm::greaterThanEqual(p, low)) && glm::all(glm::lessThanEqual(p, low + 9.0));
      EXPECT_EQ(std::count(found.begin(), found.end(), part), inside ? 1 : 0);
    }
  }
}

TEST(PartFinderTest, PlacesSayWhatIsAPartsOwnAndWhatBothSidesSee) {
  const EightParts eight;
  const PartFinder& finder = eight.finder;
  EXPECT_TRUE(finder.place(0, {4, 4, 4}).own);
  EXPECT_FALSE(finder.place(0, {4, 4, 4}).near_border);
  EXPECT_TRUE(finder.place(0, {7.9, 4, 4}).own);
  EXPECT_TRUE(finder.place(0, {7.9, 4, 4}).near_border);
  EXPECT_FALSE(finder.place(1, {7.9, 4, 4}).own);
  EXPECT_TRUE(finder.place(1, {7.9, 4, 4}).near_border);
  EXPECT_FALSE(finder.place(1, {7.6, 4, 4}).near_border) << "the outer half of a halo";
}

}  // namespace
}  // namespace surfcast::builder
