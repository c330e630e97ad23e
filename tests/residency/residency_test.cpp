#include "residency/residency.h"

#include <atomic>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/stopwatch.h"
#include "residency/fake_blocks.h"

namespace surfcast::residency {
namespace {

using testing::block_at;
using ::testing::ElementsAre;
using testing::FakeBlocks;
using testing::FakeSink;
using ::testing::IsEmpty;
using testing::split;
using testing::view_from;

/// A root, four children in a row, and four children of each. Every block takes one page.
std::shared_ptr<FakeBlocks> two_splits(uint64_t id) {
  std::vector<ldc::BlockEntry> blocks{block_at({0, 0, -20}, 4, 1)};
  const uint32_t first = split(blocks, 0, 4, 1000);
  for (uint32_t i = 0; i < 4; ++i) split(blocks, first + i, 4, 1000);
  return std::make_shared<FakeBlocks>(id, blocks);
}

class ResidencyTest : public ::testing::Test {
 protected:
  void start(uint32_t pages, size_t upload_bytes = size_t{1} << 20) {
    residency_ = std::make_unique<Residency>(
        sink_, ResidencyLimits{pages, {.threads = 1, .cache_bytes = 0, .ready_bytes = size_t{1} << 20}, upload_bytes});
  }
  Result<PreparedView> whole(const ViewedModel& model, double spacing = 0) {
    return residency_->prepare_complete(model, {frame_, spacing}, never_);
  }
  Result<PreparedView> whole_with_attributes(const ViewedModel& model) {
    return residency_->prepare_complete(model, {frame_, 0, nullptr, true}, never_);
  }
  PreparedView now(const ViewedModel& model, double spacing = 0, bool moving = false) {
    return residency_->prepare_resident(model, {.frame = frame_, .spacing = spacing, .moving = moving}, {}, {});
  }
  /// Prepares pictures without waiting until one converges.
  PreparedView now_until_converged(const ViewedModel& model, double spacing = 0) {
    for (int i = 0; i < 20'000; ++i) {
      PreparedView view = now(model, spacing);
      if (view.selection.converged()) return view;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "never converged";
    return {};
  }
  /// Checks that each drawn block is in memory where the pool says.
  void expect_in_memory(const FakeBlocks& source, const std::vector<uint32_t>& blocks) {
    for (const uint32_t block : blocks) {
      const ResidentBlock resident = residency_->pool().at({source.id(), block});
      ASSERT_FALSE(resident.pages.empty());
      EXPECT_EQ(sink_.at(size_t{resident.pages.front()} * BlockPool::kPageTexels), block);
    }
  }

  const geometry::CameraFrame frame_ = view_from({0, 0, 0});
  const std::atomic<bool> never_{false};
  FakeSink sink_;
  std::shared_ptr<FakeBlocks> source_ = two_splits(1);
  ViewedModel model_{source_};
  std::unique_ptr<Residency> residency_;
};

TEST_F(ResidencyTest, AWholePictureWaitsForEveryBlockOfTheFinestCut) {
  start(100);
  const Result<PreparedView> view = whole(model_);
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->selection.converged());
  EXPECT_EQ(view->selection.draw.size(), 16u);
  EXPECT_EQ(view->waited_for, 17u) << "the cut and the root";
  expect_in_memory(*source_, view->selection.draw);
  const Result<PreparedView> again = whole(model_);
  EXPECT_EQ(again->waited_for, 0u);
  EXPECT_EQ(source_->started().size(), 17u);
}

TEST_F(ResidencyTest, AWholePictureLoadsWhatItShowsAndNoMore) {
  start(100);
  const double middle = selection::projected_spacing(source_->tree().blocks()[2], frame_);
  EXPECT_EQ(whole(model_, 1.2 * middle)->selection.draw.size(), 4u);
  EXPECT_THAT(source_->started(), ElementsAre(0, 1, 2, 3, 4));
}

TEST_F(ResidencyTest, AModelLargerThanTheMemoryIsShownAsFineAsFits) {
  start(22);  // one page for the pinned root; each block in use may take two
  const Result<PreparedView> view = whole(model_);
  ASSERT_TRUE(view);
  EXPECT_FALSE(view->selection.converged());
  EXPECT_TRUE(view->selection.budget_reached);
  EXPECT_EQ(view->selection.draw, view->selection.target) << "all of what fits is there";
  EXPECT_EQ(view->selection.draw.size(), 10u) << "two of the four are refined";
  EXPECT_LE(residency_->pool().bytes(), 22u * 16384);
}

TEST_F(ResidencyTest, AForestLargerThanTheMemoryIsShownInPart) {
  const auto forest = std::make_shared<FakeBlocks>(7, std::vector<ldc::BlockEntry>(20, block_at({0, 0, -10}, 1)));
  start(8);
  const Result<PreparedView> view = whole(ViewedModel(forest));
  ASSERT_TRUE(view);
  EXPECT_FALSE(view->selection.converged());
  EXPECT_EQ(view->selection.draw.size(), 8u);
}

TEST_F(ResidencyTest, APictureAtOnceNeverWaitsForABlock) {
  start(100);
  source_->hold();
  const Stopwatch watch;
  PreparedView view;
  for (int i = 0; i < 100; ++i) view = now(model_);
  EXPECT_LT(watch.seconds(), 20)
      << "a hundred pictures while no block arrives at all, each of which takes microseconds";
  EXPECT_THAT(view.selection.draw, IsEmpty());
  EXPECT_FALSE(view.selection.converged());
  EXPECT_GT(view.waited_for, 0u);
  source_->release();
  EXPECT_EQ(now_until_converged(model_).selection.draw.size(), 16u);
}

TEST_F(ResidencyTest, WhatARestWouldMissIsLoadedWhileTheViewMoves) {
  residency_ = std::make_unique<Residency>(
      sink_,
      ResidencyLimits{
          100, {.threads = 1, .idle_threads = 1, .cache_bytes = 4 << 20, .ready_bytes = 1 << 20}, size_t{1} << 20});
  const double coarse = 2 * selection::projected_spacing(source_->tree().blocks()[0], frame_);
  const ViewParameters moving{.frame = frame_, .spacing = coarse, .moving = true, .rest_spacing = 0};
  PreparedView view = residency_->prepare_resident(model_, moving, {}, {});
  EXPECT_EQ(view.selection.target.size(), 1U) << "the root is fine enough for a motion";
  source_->wait_for_start(21);
  EXPECT_EQ(now_until_converged(model_).selection.draw.size(), 16U);
}

TEST_F(ResidencyTest, PicturesAtOnceGetFinerAndAreNeverWithoutAPart) {
  start(100, 1);  // one block per picture
  size_t drawn = 0;
  const Stopwatch watch;
  while (drawn < 16 && watch.seconds() < 20) {
    std::this_thread::yield();  // let the loader threads run
    const PreparedView view = now(model_, 0, true);
    if (drawn > 0) {
      ASSERT_EQ(view.selection.holes, 0u);
      ASSERT_GE(view.selection.draw.size(), drawn);
    }
    drawn = view.selection.draw.size();
    expect_in_memory(*source_, view.selection.draw);
  }
  EXPECT_EQ(drawn, 16u);
  EXPECT_EQ(source_->started().front(), 0u) << "the root comes first";
}

TEST_F(ResidencyTest, AModelIsLoadedBetweenPicturesOfAnotherThatLacksNothing) {
  start(100);
  ASSERT_TRUE(whole(model_));
  const std::shared_ptr<FakeBlocks> other_source = two_splits(2);
  const ViewedModel other{other_source};
  bool converged = false;
  for (int i = 0; i < 5000 && !converged; ++i) {
    converged = now(other, 0, /*moving=*/true).selection.converged();
    EXPECT_TRUE(now(model_, 0, /*moving=*/true).selection.converged());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    now(model_, 0, /*moving=*/true);
  }
  EXPECT_TRUE(converged);
}

TEST_F(ResidencyTest, ALimitedNumberOfBytesIsUploadedInAPictureInMotion) {
  start(100, 20000);  // the limit is reached with the second block of 16000 bytes
  now(model_, 0, true);
  source_->wait_for_start(21);  // then twenty blocks are ready
  const size_t before = sink_.written();
  now(model_, 0, true);
  EXPECT_GT(sink_.written(), before);
  EXPECT_LE(sink_.written() - before, 32000u);  // less if the time limit is reached on a busy machine
  now(model_);
  EXPECT_GT(sink_.written() - before, 64000u) << "at rest, all that is there";
}

TEST_F(ResidencyTest, WhatTheCameraGoesToIsLoadedAfterWhatItSees) {
  start(100);
  const double root = selection::projected_spacing(source_->tree().blocks()[0], frame_);
  residency_->prepare_resident(model_, {frame_, 1.1 * root}, {}, view_from({0, 0, -10}));
  source_->wait_for_start(5);
  std::vector<uint32_t> begun = source_->started();
  EXPECT_EQ(begun.front(), 0u) << "all that the view itself needs";
}

TEST_F(ResidencyTest, DamageFailsAWholePictureAndNamesTheBlock) {
  start(100);
  source_->damage(7);
  const Result<PreparedView> view = whole(model_);
  ASSERT_FALSE(view);
  EXPECT_EQ(view.error().message, "block 7: damaged");
}

TEST_F(ResidencyTest, DamageLeavesAPictureAtOnceCoarserThere) {
  start(100);
  source_->damage(7);
  PreparedView view;
  for (int i = 0; i < 20'000 && view.selection.draw.size() < 13; ++i) {
    view = now(model_);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_THAT(view.selection.draw, ElementsAre(1, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20));
  EXPECT_FALSE(view.selection.converged());
  EXPECT_EQ(std::ranges::count(source_->started(), 7u), 1) << "it is tried once";
}

TEST_F(ResidencyTest, ARestLoadsNothingThatWouldOnlyStandInForAMoment) {
  start(100);
  EXPECT_EQ(now_until_converged(model_, 2 * selection::projected_spacing(source_->tree().blocks()[0], frame_)).missing,
            0U);
  EXPECT_EQ(now(model_).missing, 16U) << "the leaves alone";
  EXPECT_EQ(now_until_converged(model_).selection.draw.size(), 16U);
  EXPECT_EQ(source_->started().size(), 17U) << "and before them the root";
}

TEST_F(ResidencyTest, ACancelledPictureIsGivenUp) {
  start(100);
  source_->hold();
  std::atomic<bool> cancelled{false};
  std::jthread canceller([&] {
    source_->wait_for_start(1);
    cancelled = true;
  });
  const Result<PreparedView> view = residency_->prepare_complete(model_, {frame_, 0}, cancelled);
  ASSERT_FALSE(view);
  EXPECT_EQ(view.error().kind, ErrorKind::kCancelled);
  source_->release();
}

TEST_F(ResidencyTest, AWholePictureLosesNothingToThoseThatInterruptItWhileItWaits) {
  const std::shared_ptr<FakeBlocks> other = two_splits(2);
  const ViewedModel second(other);
  for (const ViewedModel* interrupting : std::initializer_list<const ViewedModel*>{&second, &model_}) {
    start(34);
    int nested_frames = 0;
    const Preemption preemption(never_, [&] {
      if (nested_frames++ % 8 != 0) return false;  // else blocks that load slowly would be replaced for ever
      residency_->begin_nested_frame();
      now(*interrupting, 0.5, /*moving=*/true);
      residency_->end_nested_frame();
      return true;
    });
    const Result<PreparedView> view = residency_->prepare_complete(model_, {frame_, 0}, preemption);
    ASSERT_TRUE(view);
    EXPECT_TRUE(view->selection.converged());
    EXPECT_GT(nested_frames, 0);
    expect_in_memory(*source_, view->selection.draw);
  }
}

TEST_F(ResidencyTest, ModelsShareTheMemoryAndTheOneDrawnLeastRecentlyGivesWay) {
  const std::shared_ptr<FakeBlocks> other = two_splits(2);
  const ViewedModel second(other);
  start(44);
  ASSERT_TRUE(whole(model_)->selection.converged());
  ASSERT_TRUE(whole(second)->selection.converged());
  EXPECT_LE(residency_->pool().bytes(), 44u * 16384);
  EXPECT_TRUE(residency_->pool().residents(1)[0]) << "the root stays, to stand in";
  ASSERT_TRUE(whole(model_)->selection.converged());
  residency_->release_model(1);
  residency_->release_model(2);
  EXPECT_EQ(residency_->pool().blocks(), 0u);
}

TEST_F(ResidencyTest, WhenTheViewBecomesCoarserNothingFallsBackToTheRoot) {
  start(100);
  ASSERT_TRUE(whole(model_)->selection.converged());
  source_->hold();
  const double middle = selection::projected_spacing(source_->tree().blocks()[2], frame_);
  const PreparedView view = now(model_, 1.2 * middle);
  EXPECT_EQ(view.selection.draw.size(), 16u);
  source_->release();
}

TEST_F(ResidencyTest, AttributesOfResidentBlocksAreAddedInPlace) {
  start(64);
  const auto source = two_splits(1);
  const ViewedModel model(source);
  const PreparedView plain = *whole(model);
  const size_t bytes = residency_->pool().bytes();
  const size_t written = sink_.written();
  const Result<PreparedView> view = whole_with_attributes(model);
  ASSERT_TRUE(view);
  EXPECT_EQ(view->selection.draw, plain.selection.draw);
  EXPECT_TRUE(view->selection.converged());
  EXPECT_EQ(sink_.written(), written) << "surfels are where they were";
  EXPECT_GT(residency_->pool().bytes(), bytes);
  EXPECT_LE(residency_->pool().bytes(), bytes / 4 * 5);
  for (const uint32_t block : view->selection.draw) {
    const ResidentBlock resident = residency_->pool().at({1, block});
    ASSERT_TRUE(resident.intensity);
    EXPECT_EQ(sink_.attribute_at(size_t{resident.pages.front()} * BlockPool::kPageTexels), block);
  }
}

TEST_F(ResidencyTest, BlocksWithAttributesServePicturesWithoutAndAreLoadedOnce) {
  start(64);
  const auto source = two_splits(1);
  const ViewedModel model(source);
  ASSERT_TRUE(whole_with_attributes(model));
  const size_t begun = source->started().size();
  EXPECT_EQ(whole(model)->waited_for, 0u);
  EXPECT_EQ(whole_with_attributes(model)->waited_for, 0u);
  EXPECT_EQ(source->started().size(), begun);
}

/// A view that switches between colours by attribute and stored colours while blocks arrive.
class SwitchedColorsTest : public ResidencyTest {
 protected:
  PreparedView now_by(bool attributes, bool moving) {
    return residency_->prepare_resident(model_, {.frame = frame_, .attributes = attributes, .moving = moving}, {}, {});
  }
  /// Checks that the drawn blocks have the attributes for their colours, and that only complete views are reported
  /// complete.
  void expect_honest(const PreparedView& view, bool attributes) {
    const std::vector<bool>& here = residency_->pool().residents(1, attributes);
    for (const uint32_t block : view.selection.draw) {
      ASSERT_LT(block, here.size());
      ASSERT_TRUE(here[block]) << "block " << block << (attributes ? " by attribute" : " as scanned");
      ASSERT_EQ(residency_->pool().at({1, block}).intensity.has_value() || !attributes, true);
    }
    const bool all = view.selection.draw == view.selection.target;
    ASSERT_EQ(view.selection.converged(), all);
    ASSERT_EQ(view.nothing_pending, all && view.selection.holes == 0);
    ASSERT_EQ(view.missing == 0, view.nothing_pending);
  }
  void expect_converging(bool attributes) {
    for (int i = 0; i < 20'000; ++i) {
      const PreparedView view = now_by(attributes, false);
      expect_honest(view, attributes);
      if (HasFatalFailure() || view.selection.converged()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "never converged";
  }
};

TEST_F(SwitchedColorsTest, WhatIsShownByAttributeHasTheAttribute) {
  start(64);
  expect_converging(false);
  const PreparedView first = now_by(true, false);
  expect_honest(first, true);
  EXPECT_FALSE(first.selection.converged());
  EXPECT_THAT(first.selection.draw, IsEmpty()) << "no block has its attributes";
  EXPECT_GT(first.selection.holes, 0U) << "so that a view does not show it";
  expect_converging(true);
}

TEST_F(SwitchedColorsTest, SwitchingBackIsThereAtOnce) {
  start(64);
  expect_converging(false);
  source_->hold();
  now_by(true, false);
  const PreparedView back = now_by(false, false);
  expect_honest(back, false);
  EXPECT_TRUE(back.selection.converged());
  source_->release();
}

TEST_F(SwitchedColorsTest, BlocksThatArriveAfterASwitchAreNotTakenForOthers) {
  start(64, 1);
  for (int round = 0; round < 40; ++round) {
    const bool attributes = round / 3 % 2 == 1;
    for (int i = 0; i < 4; ++i) expect_honest(now_by(attributes, round % 2 == 0), attributes);
    std::this_thread::sleep_for(std::chrono::microseconds(200 * (round % 5)));  // for some blocks, or none
    if (HasFatalFailure()) return;
  }
  expect_converging(true);
  expect_converging(false);
}

TEST_F(ResidencyTest, EvictedBlocksLoseTheirAttributes) {
  start(64);
  const auto source = two_splits(1);
  const ViewedModel model(source);
  ASSERT_TRUE(whole_with_attributes(model));
  residency_->release_model(1);
  EXPECT_EQ(residency_->pool().bytes(), 0u);
  ASSERT_TRUE(whole(model));
  EXPECT_GT(whole_with_attributes(model)->waited_for, 0u);
}

/// A root, four children, sixteen grandchildren and 64 leaves of 1000 surfels.
std::shared_ptr<FakeBlocks> three_splits(uint64_t id) {
  std::vector<ldc::BlockEntry> blocks{block_at({0, 0, -20}, 4, 1)};
  for (uint32_t i = 0; i < 21; ++i) split(blocks, i, 4, 1000);
  return std::make_shared<FakeBlocks>(id, blocks);
}

class SurveyTest : public ResidencyTest {
 protected:
  /// The finest picture; of more than so many surfels a survey that shows the four children.
  [[nodiscard]] ViewParameters surveyed_above(double surfels) const {
    const double spacing = 0.9 * selection::projected_spacing(leaves_->tree().blocks()[0], frame_);
    return {.frame = frame_, .survey = ViewParameters::Survey{surfels, spacing}};
  }

  std::shared_ptr<FakeBlocks> leaves_ = three_splits(9);
  ViewedModel tree_{leaves_};
};

TEST_F(SurveyTest, APictureOfManySurfelsIsSurveyed) {
  start(400);
  const Result<PreparedView> view = residency_->prepare_complete(tree_, surveyed_above(63'999), never_);
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->survey);
  EXPECT_THAT(view->selection.draw, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(leaves_->started(), ElementsAre(0, 1, 2, 3, 4));
}

TEST_F(SurveyTest, APictureOfFewSurfelsIsNot) {
  start(400);
  const Result<PreparedView> view = residency_->prepare_complete(tree_, surveyed_above(64'000), never_);
  ASSERT_TRUE(view);
  EXPECT_FALSE(view->survey);
  EXPECT_EQ(view->selection.draw.size(), 64U);
}

/// Whether a picture is surveyed depends on the picture alone: the same request has the same bytes.
TEST_F(SurveyTest, ResidentBlocksDoNotSpareASurvey) {
  start(400);
  ASSERT_TRUE(whole(tree_));
  const Result<PreparedView> view = residency_->prepare_complete(tree_, surveyed_above(63'999), never_);
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->survey);
  EXPECT_THAT(view->selection.draw, ElementsAre(1, 2, 3, 4));
}

TEST_F(SurveyTest, AViewRequestsTheBlocksOfItsSurveyAlone) {
  start(400);
  leaves_->hold();
  const PreparedView view = residency_->prepare_resident(tree_, surveyed_above(63'999), {}, {});
  EXPECT_TRUE(view.survey);
  EXPECT_THAT(view.selection.target, ElementsAre(1, 2, 3, 4));
  EXPECT_LT(view.missing, 64U);
  leaves_->release();
}

TEST_F(SurveyTest, AViewInMotionPrefetchesTheSurveyOfItsRest) {
  residency_ = std::make_unique<Residency>(
      sink_,
      ResidencyLimits{
          400, {.threads = 1, .idle_threads = 1, .cache_bytes = 4 << 20, .ready_bytes = 1 << 20}, size_t{1} << 20});
  ViewParameters moving = surveyed_above(63'999);
  moving.spacing = 2 * selection::projected_spacing(leaves_->tree().blocks()[0], frame_);
  moving.moving = true;
  moving.rest_spacing = 0;
  const PreparedView view = residency_->prepare_resident(tree_, moving, {}, {});
  EXPECT_FALSE(view.survey);
  EXPECT_EQ(view.selection.target.size(), 1U) << "the root is fine enough for a motion";
  leaves_->wait_for_start(5);
  EXPECT_THAT(leaves_->started(), ::testing::Each(::testing::Lt(5U))) << "the root and its children alone";
}

TEST_F(SurveyTest, WhatASurveyHidesIsNotLoaded) {
  start(400);
  selection::VisibleDepths wall(frame_.width, frame_.height, 0);
  const std::vector<selection::DepthRange> near(static_cast<size_t>(frame_.width), {1, 1});
  for (int y = 0; y < frame_.height; ++y) wall.enter(0, y, near);
  const selection::Visibility visible(std::move(wall), frame_, std::numeric_limits<double>::infinity());
  const Result<PreparedView> view = residency_->prepare_complete(tree_, {.frame = frame_, .visible = &visible}, never_);
  ASSERT_TRUE(view);
  EXPECT_FALSE(view->survey);
  EXPECT_THAT(view->selection.draw, ElementsAre(0));
  EXPECT_THAT(leaves_->started(), ElementsAre(0));
}

/// Blocks whose header tells one centre: the number of the block.
class CentredBlocks : public FakeBlocks {
 public:
  using FakeBlocks::FakeBlocks;
  [[nodiscard]] Result<PackedBlock> load(uint32_t block, bool attributes) const override {
    return FakeBlocks::load(block, attributes).map([](PackedBlock packed) {
      packed.header = std::make_shared<const Header>();
      return packed;
    });
  }

 private:
  class Header : public BlockHeader {
   public:
    [[nodiscard]] glm::vec4 scale(int /*unit*/) const override { return {}; }
    void add_runs(const selection::RadiusRange& /*wanted*/, std::vector<TexelRun>& /*runs*/) const override {}
    [[nodiscard]] size_t centres(const PackedBlock& /*block*/) const override { return 1; }
    [[nodiscard]] glm::dvec3 centre(const PackedBlock& block, size_t /*i*/) const override {
      return glm::dvec3(block.texels.front().x);
    }
  };
};

Result<std::vector<glm::dvec3>> centres_of(Residency& residency, const ViewedModel& model, uint32_t block,
                                           bool attributes) {
  return residency.packed(model, block, attributes).map([](const std::shared_ptr<const PackedBlock>& packed) {
    std::vector<glm::dvec3> centres;
    for (size_t i = 0; i < packed->header->centres(*packed); ++i) centres.push_back(packed->header->centre(*packed, i));
    return centres;
  });
}

TEST(ResidencyCentres, AreThoseOfABlockInHostMemoryOrLoadedAgain) {
  const auto source = std::make_shared<CentredBlocks>(
      1, std::vector<ldc::BlockEntry>{testing::block_at({0, 0, -10}, 1), testing::block_at({5, 0, -10}, 1)});
  const ViewedModel model(source);
  testing::FakeSink sink;
  Residency residency(
      sink, ResidencyLimits{400, {.threads = 1, .cache_bytes = 4 << 20, .ready_bytes = 1 << 20}, size_t{1} << 20});
  const Result<std::vector<glm::dvec3>> loaded = centres_of(residency, model, 1, false);
  ASSERT_TRUE(loaded);
  EXPECT_THAT(*loaded, ElementsAre(glm::dvec3(1)));
  EXPECT_THAT(source->started(), ElementsAre(1));
  const std::atomic<bool> never{false};
  ASSERT_TRUE(residency.prepare_complete(model, {.frame = testing::view_from({0, 0, 0})}, never));
  const size_t before = source->started().size();
  EXPECT_THAT(*centres_of(residency, model, 1, false), ElementsAre(glm::dvec3(1)));
  EXPECT_EQ(source->started().size(), before);
  source->damage(0);
  EXPECT_TRUE(centres_of(residency, model, 0, false)) << "in host memory";
  EXPECT_FALSE(centres_of(residency, model, 0, true)) << "with attributes it is not";
}

}  // namespace
}  // namespace surfcast::residency
