#include "exporter/node_sample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::exporter {
namespace {

using ::testing::ElementsAre;

/// Points apart from each other, or all in one place, the first of which come first in an even sample.
std::vector<SamplePoint> points(size_t count, float step) {
  std::vector<SamplePoint> all(count);
  for (size_t i = 0; i < count; ++i) all[i] = {{0.1F + step * static_cast<float>(i), 0.5F, 0.5F}, 10 * i};
  return all;
}

TEST(NodeSampleTest, ChildrenWithoutNodesBelowGiveAllTheirPoints) {
  const ChildPoints children[] = {{0, 2, false}, {2, 3, false}};
  EXPECT_THAT(node_sample(points(5, 0.1F), children, 0), ElementsAre(0U, 1U, 2U, 3U, 4U));
}

TEST(NodeSampleTest, AChildWithNodesBelowKeepsThePointThatIsChosenLast) {
  std::vector<SamplePoint> all = points(5, 0.1F);
  all[2].hash = 99;
  const ChildPoints children[] = {{0, 2, false}, {2, 3, true}};
  EXPECT_THAT(node_sample(all, children, 0), ElementsAre(0U, 1U, 3U, 4U));
}

TEST(NodeSampleTest, PointsTooCloseTogetherMakeUpForThoseThatNodesAboveTake) {
  const ChildPoints children[] = {{0, 3, true}, {3, 3, true}};
  EXPECT_THAT(node_sample(points(6, 0), children, 0), ElementsAre(0U));
  EXPECT_THAT(node_sample(points(6, 0), children, 2), ElementsAre(0U, 1U, 3U));
  EXPECT_THAT(node_sample(points(6, 0), children, 9), ElementsAre(0U, 1U, 3U, 4U));
}

}  // namespace
}  // namespace surfcast::exporter
