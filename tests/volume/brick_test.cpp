#include "volume/brick.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::volume {
namespace {

using glm::dvec3;
using glm::u32vec3;

TEST(Brick, levels_end_with_one_brick) {
  EXPECT_EQ(level_count({1, 1, 1}), 1U);
  EXPECT_EQ(level_count({32, 32, 32}), 1U);
  EXPECT_EQ(level_count({32, 33, 32}), 2U);
  EXPECT_EQ(level_count({64, 1, 1}), 2U);
  EXPECT_EQ(level_count({65, 1, 1}), 3U);
  EXPECT_EQ(level_count({1024, 1024, 1024}), 6U);
  for (const u32vec3 size : {u32vec3(1, 1, 1), u32vec3(33, 1, 2), u32vec3(256, 256, 133), u32vec3(1025, 7, 64)}) {
    EXPECT_EQ(level_bricks(size, level_count(size) - 1), u32vec3(1));
  }
}

TEST(Brick, odd_ends_are_rounded_up_and_single_samples_stay) {
  const u32vec3 size(133, 2, 1);
  EXPECT_EQ(level_size(size, 0), size);
  EXPECT_EQ(level_size(size, 1), u32vec3(67, 1, 1));
  EXPECT_EQ(level_size(size, 2), u32vec3(34, 1, 1));
  EXPECT_EQ(halvings(size, 2), u32vec3(2, 1, 0));
}

TEST(Brick, a_parent_has_the_bricks_of_its_two_children_along_each_axis) {
  for (uint32_t n = 1; n < 300; ++n) {
    const u32vec3 size(n, 300, 1);
    for (uint32_t level = 1; level < level_count(size); ++level) {
      EXPECT_EQ(level_bricks(size, level), (level_bricks(size, level - 1) + 1U) / 2U) << n << " " << level;
    }
  }
}

TEST(Brick, counts_of_bricks_add_up_to_the_samples_of_the_level) {
  for (uint32_t n = 1; n < 200; ++n) {
    const u32vec3 size(n, 1, 200);
    for (uint32_t level = 0; level < level_count(size); ++level) {
      uint32_t sum = 0;
      for (uint32_t b = 0; b < level_bricks(size, level).x; ++b) sum += brick_count(size, level, {b, 0, 0}).x;
      EXPECT_EQ(sum, level_size(size, level).x);
    }
  }
}

TEST(Brick, a_sample_of_a_level_lies_amid_the_samples_that_it_averages) {
  const u32vec3 size(64, 64, 1);
  EXPECT_EQ(source_index(size, 0, {3, 4, 0}), dvec3(3, 4, 0));
  EXPECT_EQ(source_index(size, 1, {0, 1, 0}), dvec3(0.5, 2.5, 0));
  EXPECT_EQ(source_index(size, 2, {0, 1, 0}), dvec3(1.5, 5.5, 0));
}

TEST(Brick, boxes_of_a_level_fill_the_volume_and_those_of_children_their_parents) {
  const u32vec3 size(133, 33, 1);
  EXPECT_EQ(volume_box(size).low, dvec3(0, 0, -0.5));
  EXPECT_EQ(volume_box(size).high, dvec3(132, 32, 0.5));
  for (uint32_t level = 0; level < level_count(size); ++level) {
    const u32vec3 last = level_bricks(size, level) - 1U;
    EXPECT_EQ(brick_box(size, level, u32vec3(0)).low, volume_box(size).low);
    EXPECT_EQ(brick_box(size, level, last).high, volume_box(size).high);
    for (uint32_t b = 0; b < last.x; ++b) {
      EXPECT_EQ(brick_box(size, level, {b, 0, 0}).high.x, brick_box(size, level, {b + 1, 0, 0}).low.x);
      if (level == 0) continue;
      EXPECT_EQ(brick_box(size, level, {b, 0, 0}).low.x, brick_box(size, level - 1, {2 * b, 0, 0}).low.x);
    }
  }
}

TEST(Brick, the_halo_suffices_for_cubic_reconstruction_everywhere_in_the_box) {
  const u32vec3 size(300, 77, 1);
  for (uint32_t level = 0; level < level_count(size); ++level) {
    const u32vec3 bricks = level_bricks(size, level);
    const dvec3 step(u32vec3(1) << halvings(size, level));
    for (uint32_t b = 0; b < bricks.x; ++b) {
      const IndexBox box = brick_box(size, level, {b, 0, 0});
      const double first = static_cast<double>(b * kBrickSamples) - kHaloBefore;
      const double last =
          static_cast<double>(b * kBrickSamples + brick_count(size, level, {b, 0, 0}).x - 1) + kHaloAfter;
      EXPECT_GE(std::floor((box.low.x + 0.5) / step.x - 0.5) - 1, first);
      const double end = (box.high.x + 0.5) / step.x - 0.5;
      EXPECT_LE(std::ceil(end) - 1 + 2, last);  // the cell that ends there
    }
  }
}

}  // namespace
}  // namespace surfcast::volume
