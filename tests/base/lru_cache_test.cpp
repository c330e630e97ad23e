#include "base/lru_cache.h"

#include <gtest/gtest.h>

namespace surfcast {
namespace {

std::shared_ptr<const int> value(int number) {
  return std::make_shared<const int>(number);
}

TEST(LruCache, WhatWasUsedLeastRecentlyGoesFirst) {
  LruCache<int, int> cache(30);
  for (const int key : {1, 2, 3}) cache.put(key, value(key), 10);
  EXPECT_EQ(*cache.find(1), 1);
  cache.put(4, value(4), 10);
  EXPECT_FALSE(cache.find(2));
  EXPECT_TRUE(cache.find(1) && cache.find(3) && cache.find(4));
}

TEST(LruCache, WhatIsLargerThanTheBudgetIsNotKept) {
  LruCache<int, int> cache(30);
  cache.put(1, value(1), 10);
  cache.put(2, value(2), 31);
  EXPECT_FALSE(cache.find(1));
  EXPECT_FALSE(cache.find(2));
  cache.put(3, value(3), 30);
  EXPECT_TRUE(cache.find(3)) << "nothing of the others is counted any more";
}

TEST(LruCache, ARangeOfKeysIsForgotten) {
  LruCache<int, int> cache(100);
  for (const int key : {1, 2, 3, 4}) cache.put(key, value(key), 10);
  cache.erase_range(2, 4);
  EXPECT_TRUE(cache.find(1) && cache.find(4));
  EXPECT_FALSE(cache.find(2) || cache.find(3));
}

TEST(LruCache, AValueOfAKeyThatIsThereIsNotReplaced) {
  LruCache<int, int> cache(100);
  cache.put(1, value(1), 60);
  cache.put(1, value(2), 60);
  EXPECT_EQ(*cache.find(1), 1);
}

}  // namespace
}  // namespace surfcast
