#include "selection/select_blocks.h"

#include <limits>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "selection/trees.h"

namespace surfcast::selection {
namespace {

using testing::block_at;
using ::testing::ElementsAre;
using testing::facing;
using testing::in_view;
using ::testing::IsEmpty;
using testing::random_tree;
using testing::split;
using testing::times_covered;
using testing::view_from;

std::vector<bool> all_of(const ldc::BlockTree& tree) {
  return std::vector<bool>(tree.blocks().size(), true);
}

bool is_leaf(const ldc::BlockTree& tree, uint32_t block) {
  return tree.children(block).count == 0;
}

/// Checks that every leaf in view is covered once, and every other leaf at most once.
void expect_cut(const SelectionTree& tree, const geometry::CameraFrame& frame, const std::vector<uint32_t>& cut) {
  for (uint32_t b = 0; b < tree.tree.blocks().size(); ++b) {
    if (!is_leaf(tree.tree, b)) continue;
    const int times = times_covered(tree, cut, b);
    if (in_view(tree, frame, b)) {
      ASSERT_EQ(times, 1) << "leaf " << b;
    } else {
      ASSERT_LE(times, 1) << "leaf " << b;
    }
  }
}

/// A root that faces the camera, four children in a row, and four children of each.
ldc::BlockTree two_splits() {
  std::vector<ldc::BlockEntry> blocks{block_at({0, 0, -20}, 4, 1)};
  const uint32_t first = split(blocks, 0, 4, 1000);
  for (uint32_t i = 0; i < 4; ++i) split(blocks, first + i, 4, 1000);
  return ldc::BlockTree(blocks);
}

TEST(SelectBlocks, RefinementStartsFromTheGivenRoots) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const std::vector<uint32_t> roots{1, 3};
  SelectionCriteria criteria;
  criteria.roots = &roots;
  criteria.spacing = 1e6;
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  std::vector<bool> resident(blocks.blocks().size(), false);
  const BlockSelection coarse = select_blocks(tree, frame, criteria, resident);
  EXPECT_THAT(coarse.target, ElementsAre(1, 3));
  EXPECT_EQ(coarse.holes, 2U);
  ASSERT_EQ(coarse.wanted.size(), 2U);
  EXPECT_EQ(coarse.wanted[0].urgency, std::numeric_limits<double>::infinity()) << "nothing is drawn in its place";
  criteria.spacing = 0;
  resident.assign(resident.size(), true);
  const BlockSelection fine = select_blocks(tree, frame, criteria, resident);
  EXPECT_EQ(fine.draw.size(), 8U);
  for (const uint32_t block : fine.draw)
    EXPECT_TRUE(blocks.blocks()[block].parent == 1 || blocks.blocks()[block].parent == 3);
}

TEST(SelectBlocks, RandomTreesAndCamerasAreCoveredOnceWhateverIsResident) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 300; ++k) {
    const ldc::BlockTree blocks(random_tree(random, 4, k % 2 == 0));
    const SelectionTree tree(blocks);
    const geometry::Camera camera{3.0 * glm::dvec3(unit(random), unit(random), unit(random)),
                                  glm::dvec3(unit(random), unit(random), unit(random)),
                                  {0, 0, 1},
                                  20 + 50 * std::abs(unit(random))};
    const geometry::CameraFrame frame = *geometry::make_camera_frame(camera, 300, 200);
    std::vector<bool> resident(blocks.blocks().size());
    for (size_t i = 0; i < resident.size(); ++i) resident[i] = i == 0 || unit(random) < 0.5;
    const SelectionCriteria criteria{.spacing = k % 3 == 0 ? 0 : 20 * std::abs(unit(random)),
                                     .surfels = k % 5 == 0 ? random() % 200000 + 1000 : UINT64_MAX};
    const BlockSelection s = select_blocks(tree, frame, criteria, resident);
    expect_cut(tree, frame, s.target);
    expect_cut(tree, frame, s.draw);
    ASSERT_EQ(s.holes, 0u);
    for (const uint32_t block : s.draw) ASSERT_TRUE(resident[block]);
    ASSERT_EQ(s.converged(), s.draw == s.target && !s.budget_reached);
  }
}

TEST(SelectBlocks, EveryBlockOfTheTargetIsAtTheSpacingOrALeaf) {
  std::mt19937 random(5);
  const ldc::BlockTree blocks(random_tree(random, 5, false));
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 2.5});
  for (const double spacing : {0.5, 1.0, 2.0, 4.0}) {
    const BlockSelection s = select_blocks(tree, frame, {.spacing = spacing}, all_of(blocks));
    for (const uint32_t b : s.target) {
      EXPECT_TRUE(is_leaf(blocks, b) || projected_spacing(blocks.blocks()[b], frame) <= spacing) << b;
    }
    for (const uint32_t b : s.refined) EXPECT_GT(projected_spacing(blocks.blocks()[b], frame), spacing);
  }
}

TEST(SelectBlocks, AWallOf64BlocksHasUnlikeLevelsNearAndFar) {
  // A wall along z, seen from its near end: a root with 64 cells, each with eight parts.
  std::vector<ldc::BlockEntry> blocks{block_at({1, 0, 0}, 0.1, 3)};
  blocks[0].bounds = geometry::Box{{1, -1, -128}, {1.2, 1, 0}};
  for (int i = 0; i < 64; ++i) {
    ldc::BlockEntry cell = block_at({1.1, 0, -2 * i - 1}, 1, 0.05);
    cell.parent = 0;
    cell.items = 4096;
    blocks.push_back(cell);
  }
  for (uint32_t i = 1; i <= 64; ++i) split(blocks, i, 8, 4096);
  const ldc::BlockTree entries(blocks);
  const SelectionTree tree(entries);
  const geometry::CameraFrame frame = view_from({0, 0, 4});
  const BlockSelection s = select_blocks(tree, frame, {.spacing = 0.2}, all_of(entries));
  expect_cut(tree, frame, s.draw);
  EXPECT_TRUE(std::binary_search(s.refined.begin(), s.refined.end(), 1u)) << "the nearest cell is refined";
  EXPECT_TRUE(std::binary_search(s.draw.begin(), s.draw.end(), 64u)) << "the farthest is not";
  // Blocks become coarser with the distance from the eye.
  bool refined = true;
  for (uint32_t cell = 1; cell <= 64; ++cell) {
    const bool now = std::binary_search(s.refined.begin(), s.refined.end(), cell);
    EXPECT_TRUE(refined || !now) << cell;
    refined = now;
  }
}

TEST(SelectBlocks, ASubtreeWhoseNormalsAllFaceAwayIsSkipped) {
  std::vector<ldc::BlockEntry> blocks{block_at({0, 0, -10}, 1, 0.1)};
  for (const float z : {1.0F, -1.0F}) {
    ldc::BlockEntry child = facing(block_at({0, 0, -10}, 0.5, 0.05), {0, 0, z}, 0.3F);
    child.parent = 0;
    blocks.push_back(child);
  }
  const ldc::BlockTree entries(blocks);
  EXPECT_THAT(select_blocks(SelectionTree(entries), view_from({0, 0, 0}), {}, all_of(entries)).draw, ElementsAre(1));
}

TEST(SelectBlocks, GhostsOfClippedBlocksAreSelectedCoarser) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  geometry::Clip clip;
  clip.inside.push_back({{-5, -5, -25}, {-1.5, 5, -15}});  // the first and, in part, the second child
  const double coarse = projected_spacing(blocks.blocks()[1], frame);
  SelectionCriteria criteria{.clip = &clip};
  EXPECT_THAT(select_blocks(tree, frame, criteria, all_of(blocks)).target, ::testing::Each(::testing::Lt(13U)));
  criteria.ghost_spacing = 1.5 * coarse;
  const BlockSelection ghosts = select_blocks(tree, frame, criteria, all_of(blocks));
  expect_cut(tree, frame, ghosts.target);
  EXPECT_THAT(ghosts.refined, ElementsAre(0, 1, 2)) << "what is shown is at the finest level";
  EXPECT_THAT(ghosts.target, ::testing::IsSupersetOf({3U, 4U})) << "what is clipped away is not";
  criteria.ghost_spacing = 0.5 * coarse;
  EXPECT_THAT(select_blocks(tree, frame, criteria, all_of(blocks)).refined, ElementsAre(0, 1, 2, 3, 4));
}

TEST(SelectBlocks, WhatIsSeenThroughShowsItsBackFaces) {
  const ldc::BlockTree blocks({facing(block_at({0, 0, -20}, 1), {0, 0, -1}, 0.1F)});
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  EXPECT_THAT(select_blocks(tree, frame, {}, all_of(blocks)).target, IsEmpty());
  EXPECT_THAT(select_blocks(tree, frame, {.sides = Sides::kBoth}, all_of(blocks)).target, ElementsAre(0));
}

TEST(SelectBlocks, FromWithinTheModelWhatSurroundsTheEyeIsRefinedFirst) {
  std::mt19937 random(11);
  const ldc::BlockTree blocks(random_tree(random, 5, false));
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0.1, 0.1, 0.1});
  expect_cut(tree, frame, select_blocks(tree, frame, {}, all_of(blocks)).draw);
  const BlockSelection s = select_blocks(tree, frame, {.surfels = 60000}, all_of(blocks));
  expect_cut(tree, frame, s.draw);
  EXPECT_TRUE(s.budget_reached);
  EXPECT_THAT(s.refined, ::testing::Contains(0u));
}

TEST(SelectBlocks, FromAMillionModelSizesAwayTheRootIsEnough) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  EXPECT_THAT(select_blocks(tree, view_from({0, 0, 8e6}), {.spacing = 0.5}, all_of(blocks)).draw, ElementsAre(0));
  EXPECT_EQ(select_blocks(tree, view_from({0, 0, 8e6}), {}, all_of(blocks)).draw.size(), 16u) << "unless all is wanted";
}

TEST(SelectBlocks, OneBlockIsDrawnOrNotSeen) {
  const ldc::BlockTree one({block_at({0, 0, -10}, 1)});
  const SelectionTree tree(one);
  const BlockSelection s = select_blocks(tree, view_from({0, 0, 0}), {.spacing = 1}, {true});
  EXPECT_THAT(s.draw, ElementsAre(0));
  EXPECT_TRUE(s.converged());
  EXPECT_THAT(select_blocks(tree, view_from({0, 0, -30}), {}, {true}).target, IsEmpty());
}

TEST(SelectBlocks, AForestOfSingleBlocksHasOneLevel) {
  const ldc::BlockTree forest({block_at({-3, 0, -10}, 1), block_at({3, 0, -10}, 1), block_at({0, 0, 10}, 1)});
  EXPECT_THAT(select_blocks(SelectionTree(forest), view_from({0, 0, 0}), {}, all_of(forest)).draw, ElementsAre(0, 1));
}

TEST(SelectBlocks, ASlowPathBackAndForthSwitchesEachBlockOnce) {
  std::mt19937 random(2);
  const ldc::BlockTree blocks(random_tree(random, 5, false));
  const SelectionTree tree(blocks);
  const auto switches = [&](bool remember) {
    std::vector<uint32_t> refined;
    std::vector<uint32_t> before;
    int count = 0;
    for (int k = 0; k < 200; ++k) {
      // A slow approach with a jitter of about a hundredth of the distance.
      const double z = 8 - 0.02 * k + (k % 2 == 0 ? 0.05 : -0.05);
      const BlockSelection s =
          select_blocks(tree, view_from({0.2, 0.3, z}), {.spacing = 0.5}, all_of(blocks),
                        remember ? std::span<const uint32_t>(refined) : std::span<const uint32_t>());
      if (k > 0 && s.target != before) ++count;
      before = s.target;
      refined = s.refined;
    }
    return count;
  };
  const int without = switches(false);
  const int with = switches(true);
  EXPECT_GT(with, 0) << "blocks are refined on the way";
  EXPECT_GT(without, 4 * with) << "and the path is one that flickers";
}

TEST(SelectBlocks, BlocksGoBackToCoarserOnceTheSpacingIsAFifthBelow) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  const double root = projected_spacing(blocks.blocks()[0], frame);
  const std::vector<uint32_t> refined{0};
  EXPECT_EQ(select_blocks(tree, frame, {.spacing = 1.2 * root}, all_of(blocks), refined).draw.size(), 4u);
  EXPECT_EQ(select_blocks(tree, frame, {.spacing = 1.3 * root}, all_of(blocks), refined).draw.size(), 1u);
}

TEST(SelectBlocks, TheBudgetIsNeverExceededAndWhatFitsIsUsed) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  const auto drawn = [&](uint64_t budget, uint32_t page = 1) {
    const BlockSelection s = select_blocks(tree, frame, {.surfels = budget, .page = page}, all_of(blocks));
    expect_cut(tree, frame, s.draw);
    EXPECT_EQ(s.budget_reached, s.draw.size() < 16) << budget;
    return s.draw.size();
  };
  EXPECT_EQ(drawn(1), 1u) << "the root is drawn whatever the budget";
  EXPECT_EQ(drawn(3999), 1u);
  EXPECT_EQ(drawn(4000), 4u);
  EXPECT_EQ(drawn(6999), 4u);
  EXPECT_EQ(drawn(7000), 7u);
  EXPECT_EQ(drawn(15999), 13u);
  EXPECT_EQ(drawn(16000), 16u);
  EXPECT_EQ(drawn(4000, 1024), 1u) << "four blocks take 4096";
  EXPECT_EQ(drawn(4096, 1024), 4u);
}

TEST(SelectBlocks, TheBudgetOfItemsIsKeptByTheBlocksThatHaveSome) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  std::vector<uint32_t> items(blocks.blocks().size(), 10);
  const auto drawn = [&](uint64_t budget) {
    const BlockSelection s = select_blocks(tree, frame, {.items = &items, .most_items = budget}, all_of(blocks));
    expect_cut(tree, frame, s.draw);
    EXPECT_EQ(s.budget_reached, s.draw.size() < 16) << budget;
    return s.draw.size();
  };
  EXPECT_EQ(drawn(1), 1u) << "the root is drawn whatever the budget";
  EXPECT_EQ(drawn(39), 1u);
  EXPECT_EQ(drawn(40), 4u);
  EXPECT_EQ(drawn(159), 13u);
  EXPECT_EQ(drawn(160), 16u);
  items.assign(items.size(), 0);
  EXPECT_EQ(drawn(0), 16u) << "without items";
}

TEST(SelectBlocks, WhatStandsInForACoarserBlockKeepsTheBudgetOfItems) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  std::vector<bool> resident = all_of(blocks);
  for (uint32_t b = 1; b <= 4; ++b) resident[b] = false;
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  const std::vector<uint32_t> items(blocks.blocks().size(), 10);
  const double spacing = 1.2 * projected_spacing(blocks.blocks()[2], frame);
  const auto drawn = [&](uint64_t budget) {
    return select_blocks(tree, frame, {.spacing = spacing, .items = &items, .most_items = budget}, resident).draw;
  };
  EXPECT_EQ(drawn(160).size(), 16u);
  EXPECT_THAT(drawn(80), ElementsAre(0));
}

TEST(SelectBlocks, TheLargestErrorIsRefinedFirst) {
  std::vector<ldc::BlockEntry> blocks{block_at({-4, 0, -10}, 1, 0.1), block_at({4, 0, -10}, 1, 0.3)};
  split(blocks, 0, 2, 1000);
  split(blocks, 1, 2, 1000);
  const ldc::BlockTree entries(blocks);
  const BlockSelection s =
      select_blocks(SelectionTree(entries), view_from({0, 0, 0}), {.surfels = 3000}, all_of(entries));
  EXPECT_THAT(s.draw, ElementsAre(0, 4, 5));
}

TEST(SelectBlocks, WithNothingButTheRootResidentItStandsInForAllAndTheRestIsWantedFromTheTopDown) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  std::vector<bool> resident(blocks.blocks().size());
  resident[0] = true;
  const BlockSelection s = select_blocks(tree, view_from({0, 0, 0}), {}, resident);
  EXPECT_THAT(s.draw, ElementsAre(0));
  EXPECT_FALSE(s.converged());
  ASSERT_EQ(s.wanted.size(), 20u);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(blocks.blocks()[s.wanted[i].block].parent, 0u);
  for (size_t i = 1; i < s.wanted.size(); ++i) EXPECT_LE(s.wanted[i].urgency, s.wanted[i - 1].urgency);
}

TEST(SelectBlocks, WithNothingResidentThereIsAHoleAndTheRootIsMostUrgent) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const BlockSelection s =
      select_blocks(tree, view_from({0, 0, 0}), {}, std::vector<bool>(blocks.blocks().size(), false));
  EXPECT_THAT(s.draw, IsEmpty());
  EXPECT_GT(s.holes, 0u);
  EXPECT_EQ(s.wanted.front().block, 0u);
  EXPECT_EQ(s.wanted.front().urgency, std::numeric_limits<double>::infinity());
}

TEST(SelectBlocks, AllChildrenReplaceABlockOrNoneDoes) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  std::vector<bool> resident = all_of(blocks);
  resident[2] = resident[9] = false;  // block 2 and its first child
  const BlockSelection s = select_blocks(tree, view_from({0, 0, 0}), {}, resident);
  EXPECT_THAT(s.draw, ElementsAre(0)) << "nothing stands in for block 2 but the root";
  resident[2] = true;
  EXPECT_THAT(select_blocks(tree, view_from({0, 0, 0}), {}, resident).draw,
              ElementsAre(2, 5, 6, 7, 8, 13, 14, 15, 16, 17, 18, 19, 20));
}

TEST(SelectBlocks, WhenTheViewBecomesCoarserWhatIsResidentBelowStandsIn) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  std::vector<bool> resident = all_of(blocks);
  for (uint32_t b = 1; b <= 4; ++b) resident[b] = false;
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  const double middle = projected_spacing(blocks.blocks()[2], frame);
  const BlockSelection s = select_blocks(tree, frame, {.spacing = 1.2 * middle}, resident);
  EXPECT_THAT(s.target, ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(s.draw.size(), 16u) << "sharper than asked for rather than as coarse as the root";
  EXPECT_EQ(s.wanted.size(), 4u);
  const BlockSelection tight = select_blocks(tree, frame, {.spacing = 1.2 * middle, .surfels = 8000}, resident);
  EXPECT_THAT(tight.draw, ElementsAre(0)) << "but not beyond the budget";
}

TEST(SelectBlocks, FinerSpacingsNeverDrawCoarserBlocks) {
  std::mt19937 random(17);
  for (int k = 0; k < 20; ++k) {
    const ldc::BlockTree blocks(random_tree(random, 4, false));
    const SelectionTree tree(blocks);
    const geometry::CameraFrame frame = view_from({0, 0.2, 2.0 + 0.1 * k});
    const uint64_t budget = k % 2 == 0 ? UINT64_MAX : 100000;
    std::vector<uint32_t> coarser;
    for (const double spacing : {8.0, 4.0, 2.0, 1.0, 0.5, 0.0}) {
      const BlockSelection s = select_blocks(tree, frame, {.spacing = spacing, .surfels = budget}, all_of(blocks));
      ASSERT_TRUE(std::includes(s.refined.begin(), s.refined.end(), coarser.begin(), coarser.end())) << spacing;
      coarser = s.refined;
    }
  }
}

TEST(SelectBlocks, AChainAsLongAsAHostileFileMayMakeItIsWalked) {
  std::vector<ldc::BlockEntry> blocks{block_at({0, 0, -10}, 1)};
  for (uint32_t i = 1; i < 100000; ++i) {
    blocks.push_back(block_at({0, 0, -10}, 1));
    blocks.back().parent = i - 1;
  }
  const ldc::BlockTree entries(blocks);
  EXPECT_THAT(select_blocks(SelectionTree(entries), view_from({0, 0, 0}), {}, all_of(entries)).draw,
              ElementsAre(99999));
}

TEST(BlocksInRectangle, APartOfThePictureSeesItsBlocksOnly) {
  const ldc::BlockTree forest({block_at({-5, 0, -10}, 0.5), block_at({5, 0, -10}, 0.5)});
  const SelectionTree tree(forest);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  const std::vector<uint32_t> both{0, 1};
  EXPECT_THAT(blocks_in_rectangle(tree, both, frame, 0, 0, 50, 100), ElementsAre(0));
  EXPECT_THAT(blocks_in_rectangle(tree, both, frame, 50, 0, 100, 100), ElementsAre(1));
}

TEST(SelectBlocks, AWindowNeedsTheBlocksOfTheWholePictureThatMayBeSeenInIt) {
  std::mt19937 random(5);
  for (int k = 0; k < 50; ++k) {
    const ldc::BlockTree blocks(random_tree(random, 4, k % 2 == 0));
    const SelectionTree tree(blocks);
    const geometry::CameraFrame frame = *geometry::make_camera_frame({{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 40}, 300, 200);
    SelectionCriteria criteria{.spacing = 4};
    const std::vector<uint32_t> whole = select_blocks(tree, frame, criteria, all_of(blocks)).target;
    criteria.window = Window{200, 40, 264, 104};
    const std::vector<uint32_t> target = select_blocks(tree, frame, criteria, all_of(blocks)).target;
    EXPECT_EQ(target, blocks_in_rectangle(tree, whole, frame, 200, 40, 264, 104));
    EXPECT_LE(target.size(), whole.size());
  }
}

/// Coarser than any block.
constexpr double kAnySpacing = std::numeric_limits<double>::infinity();

/// All of the view shows a wall at a depth of 12, but for columns that show the depths of the tree of two_splits().
Visibility wall_but_for(const geometry::CameraFrame& frame, int first, int last, double spacing = kAnySpacing) {
  VisibleDepths depths(frame.width, frame.height, 0);
  std::vector<DepthRange> row(static_cast<size_t>(frame.width), DepthRange{1 / 12.0F, 1 / 12.0F});
  std::fill(row.begin() + first, row.begin() + last, DepthRange{1 / 20.0F, 1 / 20.0F});
  for (int y = 0; y < frame.height; ++y) depths.enter(0, y, row);
  return {std::move(depths), frame, spacing};
}

TEST(SelectBlocks, WhatIsNotSeenIsNotRefined) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  // The children 1 to 4 of the root stand from left to right. The columns from 56 on are those of 3 and 4.
  const Visibility visible = wall_but_for(frame, 56, 100);
  SelectionCriteria criteria;
  criteria.visible = &visible;
  const BlockSelection selection = select_blocks(tree, frame, criteria, all_of(blocks));
  EXPECT_THAT(selection.refined, ElementsAre(0, 3, 4));
  EXPECT_TRUE(std::ranges::binary_search(selection.draw, 1U)) << "hidden, and drawn where it is";
  EXPECT_EQ(selection.draw.size(), 10U);
  EXPECT_TRUE(selection.converged());
  EXPECT_FALSE(selection.budget_reached);
  expect_cut(tree, frame, selection.draw);
}

TEST(SelectBlocks, WhatIsHardlySeenMayBeCoarser) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  // About a tenth of the pixels of child 2.
  const Visibility visible = wall_but_for(frame, 49, 50);
  SelectionCriteria criteria;
  criteria.visible = &visible;
  criteria.spacing = 0.9 * projected_spacing(blocks.blocks()[2], frame);
  const auto is_refined = [&] {
    const BlockSelection selection = select_blocks(tree, frame, criteria, all_of(blocks));
    return std::ranges::binary_search(selection.refined, 2U);
  };
  EXPECT_FALSE(is_refined());
  criteria.visible = nullptr;
  EXPECT_TRUE(is_refined());
  criteria.visible = &visible;
  criteria.spacing *= 0.5;
  EXPECT_TRUE(is_refined());
}

TEST(SelectBlocks, WhatIsHiddenIsAsFineAsTheCoarsePicture) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  SelectionCriteria criteria;
  criteria.spacing = 0.5 * projected_spacing(blocks.blocks()[1], frame);
  const auto refined_with = [&](double spacing) {
    const Visibility visible = wall_but_for(frame, 0, 0, spacing);  // hides all
    criteria.visible = &visible;
    return select_blocks(tree, frame, criteria, all_of(blocks)).refined;
  };
  EXPECT_THAT(refined_with(1.5 * projected_spacing(blocks.blocks()[0], frame)), ElementsAre());
  EXPECT_THAT(refined_with(1.5 * projected_spacing(blocks.blocks()[1], frame)), ElementsAre(0));
}

/// The boxes are seen, but of the surfels of the root only those in child 3.
TEST(SelectBlocks, WhatHasNoSurfelThatIsSeenIsNotRefined) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  const geometry::Box& shown = tree.hulls[3].centres;
  VisibleDepths depths(frame.width, frame.height, 0);
  const int first = static_cast<int>(frame.project(frame.to_camera({shown.min.x, 0, -20})).x);
  const int last = static_cast<int>(frame.project(frame.to_camera({shown.max.x, 0, -20})).x);
  std::vector<DepthRange> row(static_cast<size_t>(frame.width), DepthRange{1 / 12.0F, 1 / 12.0F});
  std::fill(row.begin() + first, row.begin() + last + 1, DepthRange{1 / 20.0F, 1 / 20.0F});
  for (int y = 0; y < frame.height; ++y) {
    // The upper half of the picture shows the depths of all blocks.
    const bool upper = y < frame.height / 2;
    const std::vector<DepthRange> far(row.size(), DepthRange{1 / 20.0F, 1 / 20.0F});
    depths.enter(0, y, upper ? far : row);
  }
  Visibility visible(std::move(depths), frame, kAnySpacing);
  std::vector<glm::dvec3> centres;
  for (uint32_t child = 1; child <= 4; ++child) {
    for (int i = 0; i < 50; ++i) centres.push_back(tree.hulls[child].centres.centre() - glm::dvec3(0, 0.01 * i, 0));
  }
  SelectionCriteria criteria;
  criteria.spacing = 0.5 * projected_spacing(blocks.blocks()[1], frame);
  criteria.visible = &visible;
  EXPECT_THAT(select_blocks(tree, frame, criteria, all_of(blocks)).refined, ElementsAre(0, 1, 2, 3, 4));
  visible.enter(0, centres.size(), [&](size_t i) { return centres[i]; });
  EXPECT_THAT(select_blocks(tree, frame, criteria, all_of(blocks)).refined, ElementsAre(0, 3));
}

TEST(SelectBlocks, WhatIsHiddenLeavesTheBudgetToWhatIsSeen) {
  const ldc::BlockTree blocks = two_splits();
  const SelectionTree tree(blocks);
  const geometry::CameraFrame frame = view_from({0, 0, 0});
  const Visibility visible = wall_but_for(frame, 56, 100);
  SelectionCriteria criteria;
  criteria.surfels = 10'000;
  const auto finest_on_the_right = [&] {
    const BlockSelection selection = select_blocks(tree, frame, criteria, all_of(blocks));
    return std::ranges::count_if(selection.draw, [&](uint32_t block) { return block >= 13; });
  };
  EXPECT_LT(finest_on_the_right(), 8) << "leaves below the children 3 and 4";
  criteria.visible = &visible;
  EXPECT_EQ(finest_on_the_right(), 8);
}

}  // namespace
}  // namespace surfcast::selection
