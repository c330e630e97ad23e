#include "service/renderer_choice.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::service {
namespace {

constexpr size_t kModels = 3000;

std::string model_name(size_t model) {
  return "model" + std::to_string(model);
}

TEST(RendererChoiceTest, ModelsAreSpreadEvenly) {
  constexpr size_t kRenderers = 5;
  std::vector<size_t> first(kRenderers);
  std::vector<size_t> second(kRenderers);
  for (size_t i = 0; i < kModels; ++i) {
    const RendererChoice choice = rank_renderers(model_name(i), kRenderers);
    EXPECT_NE(choice.first, choice.second);
    ++first.at(choice.first);
    ++second.at(choice.second);
  }
  // Five standard deviations of a binomial distribution.
  const double bound = 5 * std::sqrt(kModels * 0.2 * 0.8);
  for (const auto& counts : {first, second}) {
    for (const size_t count : counts) EXPECT_NEAR(static_cast<double>(count), kModels / 5.0, bound);
  }
}

TEST(RendererChoiceTest, AModelMovesOnlyToTheRendererThatIsAdded) {
  size_t moved = 0;
  for (size_t i = 0; i < kModels; ++i) {
    const RendererChoice before = rank_renderers(model_name(i), 3);
    const RendererChoice after = rank_renderers(model_name(i), 4);
    if (after.first == before.first) continue;
    EXPECT_EQ(after.first, 3U);
    EXPECT_EQ(after.second, before.first) << "who had it is the next in line";
    ++moved;
  }
  EXPECT_NEAR(static_cast<double>(moved), kModels / 4.0, 5 * std::sqrt(kModels * 0.25 * 0.75));
}

TEST(RendererChoiceTest, OneRendererDrawsAll) {
  const RendererChoice only = rank_renderers("cube", 1);
  EXPECT_EQ(only.first, 0U);
  EXPECT_EQ(only.second, 0U);
  EXPECT_EQ(choose_renderer(only, 100, 100, std::nullopt), 0U);
  EXPECT_EQ(choose_renderer(only, 100, 100, 0), 0U);
}

TEST(RendererChoiceTest, TheSecondOneDrawsWhereManyWait) {
  const RendererChoice choice{2, 5};
  EXPECT_EQ(choose_renderer(choice, 0, 0, std::nullopt), 2U);
  EXPECT_EQ(choose_renderer(choice, 3, 0, std::nullopt), 2U);
  EXPECT_EQ(choose_renderer(choice, 4, 0, std::nullopt), 5U);
  EXPECT_EQ(choose_renderer(choice, 100, 97, std::nullopt), 2U);
}

TEST(RendererChoiceTest, AViewStaysWhereItsBlocksAre) {
  const RendererChoice choice{2, 5};
  EXPECT_EQ(choose_renderer(choice, 0, 3, 5), 5U);
  EXPECT_EQ(choose_renderer(choice, 0, 4, 5), 2U) << "many wait there";
  EXPECT_EQ(choose_renderer(choice, 3, 0, 2), 2U);
  EXPECT_EQ(choose_renderer(choice, 0, 0, 7), 2U) << "the view shows another model now";
}

/// Views of one model, each with a picture that waits, end on both renderers.
TEST(RendererChoiceTest, ManyViewsOfAModelAreDividedBetweenTwo) {
  const RendererChoice choice{0, 1};
  std::vector<size_t> former(20, 0);
  for (int round = 0; round < 3; ++round) {
    for (size_t view = 0; view < former.size(); ++view) {
      const auto on = [&](size_t renderer) {
        return static_cast<size_t>(std::ranges::count(former, renderer)) - (former[view] == renderer ? 1 : 0);
      };
      former[view] = choose_renderer(choice, on(0), on(1), former[view]);
    }
  }
  EXPECT_NEAR(static_cast<double>(std::ranges::count(former, size_t{1})), 10, 3);
}

}  // namespace
}  // namespace surfcast::service
