#include "surfel/drawn_radius.h"

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

}  // namespace
}  // namespace surfcast::surfel
