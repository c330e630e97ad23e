#include "surfel/drawn_radius.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::surfel {
namespace {

TEST(LargestDrawnRadius, OutliersAreHeldBackAndOrdinarySurfelsAreNot) {
  std::vector<float> radii(100, 0.01F);
  EXPECT_FLOAT_EQ(largest_drawn_radius(radii), 0.04F);
  radii[7] = 1;
  EXPECT_FLOAT_EQ(largest_drawn_radius(radii), 0.04F);
  EXPECT_FLOAT_EQ(largest_drawn_radius(std::vector<float>{0.5F}), 2);
}

TEST(LargestDrawnRadius, SmallSplatsOfScatterDoNotHoldDiscsBack) {
  std::vector<float> radii(100, 0.001F);
  std::vector<uint8_t> scatter(100, 1);
  for (const size_t disc : {3, 50, 51}) {
    radii[disc] = 0.01F;
    scatter[disc] = 0;
  }
  EXPECT_FLOAT_EQ(largest_drawn_radius(radii, scatter), 0.04F);
  EXPECT_FLOAT_EQ(largest_drawn_radius(radii, {}), 0.004F) << "all are discs";
  EXPECT_TRUE(std::isinf(largest_drawn_radius(radii, std::vector<uint8_t>(100, 1)))) << "there are no discs";
}

}  // namespace
}  // namespace surfcast::surfel
