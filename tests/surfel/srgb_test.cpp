#include "surfel/srgb.h"

#include <gtest/gtest.h>

namespace surfcast::surfel {
namespace {

TEST(Srgb, EveryColorOfBothDepthsComesBack) {
  for (int value = 0; value < 256; ++value) {
    const glm::u16vec3 color(value, 255 - value, 7);
    ASSERT_EQ(from_linear(to_linear(color, 8), 8), color);
  }
  for (int value = 0; value < 65536; value += 11) {
    const glm::u16vec3 color(value, 65535 - value, 700);
    ASSERT_EQ(from_linear(to_linear(color, 16), 16), color);
  }
}

TEST(Srgb, KnownValuesOfTheStandard) {
  EXPECT_NEAR(to_linear(glm::u16vec3(188), 8).r, 0.5029, 1e-4);
  EXPECT_NEAR(to_linear(glm::u16vec3(10), 8).r, 10 / 255.0 / 12.92, 1e-7);
  EXPECT_EQ(from_linear(glm::vec3(-1, 0.5F, 2), 8), glm::u16vec3(0, 188, 255));
}

}  // namespace
}  // namespace surfcast::surfel
