// Far more coincident points than any block holds.

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "ldc/coarse_samples.h"
#include "ldc/subtree.h"
#include "surfel/normalization_weights.h"

namespace surfcast::ldc {
namespace {

TEST(DenseCluster, OfAMillionPointsIsBuilt) {
  constexpr size_t kPoints = 1000000;
  std::vector<CoarseSurfel> spot(kPoints, surfel_at({0.1, 0.2, 0.3}));
  spot.push_back(surfel_at({7, 7, 7}));
  surfel::SurfelCloud cloud = make_coarse_cloud(spot, {});
  cloud.weights = surfel::normalization_weights(cloud);
  const Subtree tree = build_subtree(cloud, whole_region(cloud), {}, 0);
  size_t leaves = 0;
  size_t surfels = 0;
  for (const TreeBlock& block : tree.blocks) {
    if (block.coarse) continue;
    ++leaves;
    surfels += block.members.size();
    EXPECT_LE(block.members.size(), 16384U);
  }
  EXPECT_EQ(surfels, kPoints + 1);
  EXPECT_LT(leaves, 140U);
  EXPECT_EQ(tree.blocks.back().coarse->size(), 2U);
}

}  // namespace
}  // namespace surfcast::ldc
