#include "render/scale_search.h"

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

/// Searches for a time with pictures that take `constant` and `pixels` milliseconds at their own size.
ScaleTime found_in(double asked, double constant, double pixels, int& drawn) {
  ScaleSearch search(asked, constant + pixels);
  drawn = 0;
  while (const std::optional<double> next = search.next()) {
    EXPECT_GT(*next, 0);
    EXPECT_LT(*next, 1);
    search.add({*next, constant + pixels * *next * *next});
    if (++drawn > 10) break;
  }
  return search.best();
}

TEST(ScaleSearch, FindsTheScaleOfATime) {
  for (const double constant : {5.0, 40.0, 120.0}) {
    for (const double pixels : {150.0, 600.0, 4000.0}) {
      int drawn = 0;
      const ScaleTime found = found_in(200, constant, pixels, drawn);
      EXPECT_LE(found.milliseconds, 220) << constant << ' ' << pixels;
      EXPECT_GE(found.milliseconds, constant + pixels <= 220 ? 0 : 160) << constant << ' ' << pixels;
      EXPECT_LE(drawn, 4);
    }
  }
}

TEST(ScaleSearch, APictureThatFitsIsNotReduced) {
  int drawn = 0;
  EXPECT_EQ(found_in(200, 20, 150, drawn).scale, 1);
  EXPECT_EQ(drawn, 0);
}

TEST(ScaleSearch, ATimeThatNoSizeHasEndsWithTheSmallest) {
  int drawn = 0;
  const ScaleTime found = found_in(10, 300, 300, drawn);
  EXPECT_EQ(found.scale, 0.125);
  EXPECT_LE(drawn, 4);
}

TEST(ScaleSearch, TimesThatVaryEndTheSearch) {
  ScaleSearch search(100, 400);
  int drawn = 0;
  for (std::optional next = search.next(); next; next = search.next()) {
    search.add({*next, drawn % 2 == 0 ? 500.0 : 90.0});
    ASSERT_LE(++drawn, 4);
  }
  EXPECT_LE(search.best().milliseconds, 110);
}

}  // namespace
}  // namespace surfcast::render
