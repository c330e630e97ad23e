#include "estimation/keep_up_to.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::estimation {
namespace {

TEST(KeepUpTo, KeepsTheKeysInTheirOrderWhateverTheirNumber) {
  constexpr int32_t kMost = std::numeric_limits<int32_t>::max();
  std::mt19937 random(1);
  for (size_t count = 0; count < 100; ++count) {
    for (const int32_t last : {-1, 0, 100, 500, 999, kMost - 1, kMost}) {
      std::vector<int32_t> keys(count);
      for (int32_t& key : keys) key = random() % 8 == 0 ? kMost : static_cast<int32_t>(random() % 1000);
      std::vector<int32_t> expected;
      std::ranges::copy_if(keys, std::back_inserter(expected), [&](int32_t key) { return key <= last; });
      const size_t kept = keep_up_to(last, count, keys.data());
      ASSERT_EQ(kept, expected.size()) << count << " " << last;
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), keys.begin())) << count << " " << last;
    }
  }
}

}  // namespace
}  // namespace surfcast::estimation
