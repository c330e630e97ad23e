#include "estimation/signed_forest.h"

#include <random>

#include <gtest/gtest.h>

namespace surfcast::estimation {
namespace {

TEST(SignedForestTest, SignsFollowTheJoins) {
  SignedForest forest(5);
  forest.join(0, 1, true);
  forest.join(2, 3, false);
  forest.join(3, 1, true);  // 3 opposes 1, so agrees with 0
  const auto [root, zero] = forest.find(0);
  EXPECT_EQ(forest.find(1), std::pair(root, !zero));
  EXPECT_EQ(forest.find(2), std::pair(root, zero));
  EXPECT_EQ(forest.find(3), std::pair(root, zero));
  EXPECT_NE(forest.find(4).first, root);
  forest.join(0, 2, true);  // in one set already: nothing changes
  EXPECT_EQ(forest.find(2), std::pair(root, zero));
}

TEST(SignedForestTest, RandomJoinsOfMembersWithSignsGiveThoseSignsBack) {
  constexpr uint32_t kMembers = 1000;
  std::mt19937 random(3);
  std::vector<bool> signs(kMembers);
  for (uint32_t i = 0; i < kMembers; ++i) signs[i] = random() % 2 == 1;
  SignedForest forest(kMembers);
  for (int i = 0; i < 20000; ++i) {
    const auto a = static_cast<uint32_t>(random() % kMembers);
    const auto b = static_cast<uint32_t>(random() % kMembers);
    forest.join(a, b, signs[a] != signs[b]);
  }
  const auto [root, sign] = forest.find(0);
  for (uint32_t i = 0; i < kMembers; ++i) {
    EXPECT_EQ(forest.find(i).first, root);
    EXPECT_EQ(forest.find(i).second != sign, signs[i] != signs[0]);
  }
}

}  // namespace
}  // namespace surfcast::estimation
