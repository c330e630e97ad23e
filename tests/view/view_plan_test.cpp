#include "view/view_plan.h"

#include <limits>

#include <gtest/gtest.h>

namespace surfcast::view {
namespace {

using std::chrono::milliseconds;

/// A plan, a simulated clock, and a simulated client.
class ViewPlanTest : public ::testing::Test {
 protected:
  void update(bool moving, bool changed = true) { plan_.update(changed, moving, now_); }
  void pass(int ms) { now_ += milliseconds(ms); }

  /// The kind of frame to draw now.
  [[nodiscard]] std::optional<FrameKind> drawn() const { return plan_.next(now_).draw; }
  /// Milliseconds until the plan must be called again; -1: it waits for an event.
  [[nodiscard]] long asked_in() const {
    const ViewStep step = plan_.next(now_);
    return step.wake_at ? std::chrono::duration_cast<milliseconds>(*step.wake_at - now_).count() : -1;
  }
  uint64_t begin(FrameKind kind) {
    EXPECT_EQ(drawn(), kind);
    plan_.begin(++frame_, kind);
    return frame_;
  }
  /// Draws and sends a whole frame.
  void draw_and_send(FrameKind kind, FrameResult result = FrameResult::kComplete) {
    const uint64_t frame = begin(kind);
    plan_.finish(frame, result, now_);
    if (result != FrameResult::kNothing) plan_.send(kind, /*last=*/true);
  }
  void show(FrameKind kind, FrameResult result = FrameResult::kComplete) {
    draw_and_send(kind, result);
    if (result != FrameResult::kNothing) plan_.acknowledge(kind);
  }

  static constexpr uint32_t kAny = std::numeric_limits<uint32_t>::max();
  /// The number of blocks that may be missing for a frame at rest to be drawn, after `missing` were recorded.
  uint32_t max_missing_blocks(uint32_t missing, uint32_t blocks = 2000) {
    plan_.record_missing(missing, blocks, now_);
    return plan_.max_missing_blocks(now_);
  }

  ViewPlan plan_{ViewTiming{}};
  ViewTime now_ = ViewTime{} + std::chrono::hours(1);
  uint64_t frame_ = 0;
};

TEST_F(ViewPlanTest, APictureAtRestIsDrawnQuicklyThenFinelyThenFinallyAndNeverAgain) {
  update(/*moving=*/false);
  show(FrameKind::kMotion);
  EXPECT_EQ(asked_in(), 150);
  pass(150);
  show(FrameKind::kRefined);
  EXPECT_EQ(asked_in(), 350);
  pass(350);
  show(FrameKind::kFinal);
  EXPECT_EQ(drawn(), std::nullopt);
  EXPECT_EQ(asked_in(), -1);
  pass(1'000'000);
  EXPECT_EQ(drawn(), std::nullopt);
}

TEST_F(ViewPlanTest, AMotionThatIsNotSaidToHaveEndedRestsAfterAWhile) {
  update(/*moving=*/true);
  show(FrameKind::kMotion);
  EXPECT_EQ(asked_in(), 250 + 150);
}

TEST_F(ViewPlanTest, TheEndOfAMotionCountsFromItsLastMovement) {
  update(/*moving=*/true);
  show(FrameKind::kMotion);
  pass(100);
  update(/*moving=*/false, /*changed=*/false);
  EXPECT_EQ(asked_in(), 50);
}

TEST_F(ViewPlanTest, AnUpdateThatShowsNothingElseStopsNothing) {
  update(/*moving=*/false);
  show(FrameKind::kMotion);
  pass(150);
  begin(FrameKind::kRefined);
  update(/*moving=*/false, /*changed=*/false);
  EXPECT_TRUE(plan_.outdated().empty());
  EXPECT_EQ(drawn(), std::nullopt);
}

TEST_F(ViewPlanTest, AFrameIsDrawnWhileTheLastOneIsOnItsWay) {
  update(/*moving=*/true);
  draw_and_send(FrameKind::kMotion);
  update(/*moving=*/true);
  draw_and_send(FrameKind::kMotion);
  update(/*moving=*/true);
  EXPECT_EQ(drawn(), std::nullopt) << "two are on their way";
  EXPECT_FALSE(plan_.may_send());
  EXPECT_EQ(asked_in(), -1) << "only the client can change that";
  plan_.acknowledge(FrameKind::kMotion);
  EXPECT_EQ(drawn(), FrameKind::kMotion);
}

TEST_F(ViewPlanTest, TheNewestUpdateTakesThePlaceOfOneThatWaits) {
  update(/*moving=*/true);
  begin(FrameKind::kMotion);
  update(/*moving=*/true);
  const uint64_t waiting = begin(FrameKind::kMotion);
  EXPECT_EQ(plan_.retargetable(), std::nullopt) << "it shows the newest";
  update(/*moving=*/true);
  EXPECT_EQ(plan_.retargetable(), waiting);
  plan_.retarget(waiting);
  EXPECT_EQ(plan_.retargetable(), std::nullopt);
  EXPECT_EQ(drawn(), std::nullopt) << "the newest is taken care of";
}

TEST_F(ViewPlanTest, AnUpdateOutdatesFramesAtRest) {
  update(/*moving=*/false);
  show(FrameKind::kMotion);
  pass(150);
  const uint64_t fine = begin(FrameKind::kRefined);
  update(/*moving=*/true);
  EXPECT_EQ(plan_.outdated(), std::vector<uint64_t>{fine});
  plan_.drop(fine);
  EXPECT_FALSE(plan_.is_pending(fine));
  EXPECT_EQ(drawn(), FrameKind::kMotion) << "at once";
  plan_.finish(fine, FrameResult::kComplete, now_);
  EXPECT_EQ(drawn(), FrameKind::kMotion) << "what comes of it late does not matter";
}

TEST_F(ViewPlanTest, AnOlderFrameDoesNotPassForTheNewestPicture) {
  update(/*moving=*/false);
  const uint64_t old = begin(FrameKind::kMotion);
  update(/*moving=*/false);
  plan_.finish(old, FrameResult::kComplete, now_);
  plan_.send(FrameKind::kMotion, true);
  EXPECT_EQ(drawn(), FrameKind::kMotion);
}

TEST_F(ViewPlanTest, BlocksThatComeAreDrawnUntilNoneIsMissing) {
  update(/*moving=*/false);
  show(FrameKind::kMotion, FrameResult::kImprovable);
  pass(150);
  show(FrameKind::kRefined, FrameResult::kImprovable);
  EXPECT_EQ(asked_in(), 50);
  for (int i = 0; i < 20; ++i) {
    pass(50);
    show(FrameKind::kRefined, i % 2 == 0 ? FrameResult::kNothing : FrameResult::kImprovable);
  }
  pass(50);
  show(FrameKind::kRefined, FrameResult::kComplete);
  show(FrameKind::kFinal);
}

TEST_F(ViewPlanTest, BlocksThatNeverComeDoNotKeepItFromTheFinalFrame) {
  update(/*moving=*/false);
  show(FrameKind::kMotion, FrameResult::kImprovable);
  pass(150);
  show(FrameKind::kRefined, FrameResult::kImprovable);
  int looks = 0;
  for (; looks < 1000 && asked_in() == 50; ++looks) {
    pass(50);
    show(FrameKind::kRefined, FrameResult::kNothing);
  }
  EXPECT_LT(looks, 110);
  EXPECT_EQ(drawn(), FrameKind::kFinal);
}

/// A picture at rest of a large model. Blocks arrive at a constant rate; drawing takes longer with more blocks.
struct LargeModel {
  uint32_t blocks = 1000;
  double blocks_per_ms = 0.1;
  double draw_ms = 4000;  ///< with all blocks
};

TEST_F(ViewPlanTest, FewFramesAreDrawnWhileBlocksArrive) {
  const LargeModel model;
  update(/*moving=*/false);
  show(FrameKind::kMotion, FrameResult::kImprovable);
  const ViewTime rest = now_;
  pass(150);
  double work_ms = 0;
  int drawn_frames = 0;
  for (;;) {
    const double ms = std::chrono::duration<double, std::milli>(now_ - rest).count();
    const auto come = std::min(model.blocks, static_cast<uint32_t>(ms * model.blocks_per_ms));
    const uint32_t missing = model.blocks - come;
    const uint64_t frame = begin(FrameKind::kRefined);
    plan_.record_missing(missing, model.blocks, now_);
    const bool worth = drawn_frames == 0 || missing == 0 || missing <= plan_.max_missing_blocks(now_);
    if (worth) {
      const double draw_ms = model.draw_ms * come / model.blocks;
      now_ += std::chrono::microseconds(static_cast<long>(1000 * draw_ms));
      plan_.record_draw(draw_ms, come, missing, now_);
      work_ms += draw_ms;
      ++drawn_frames;
    }
    plan_.finish(frame, missing == 0 ? FrameResult::kComplete : FrameResult::kNothing, now_);
    if (missing == 0) break;
    pass(50);
  }
  const double took = std::chrono::duration<double, std::milli>(now_ - rest).count();
  EXPECT_LE(took, model.blocks / model.blocks_per_ms + 2 * model.draw_ms);
  EXPECT_LE(work_ms - model.draw_ms, 0.4 * took) << "without the last frame";
  EXPECT_GE(drawn_frames, 3) << "something is to be seen meanwhile";
  EXPECT_EQ(drawn(), FrameKind::kFinal);
}

TEST_F(ViewPlanTest, AFrameThatShowsLittleMoreIsNotDrawn) {
  update(/*moving=*/false);
  plan_.record_draw(/*draw_ms=*/100, /*blocks=*/2000, /*missing=*/40, now_);
  pass(199);
  EXPECT_EQ(max_missing_blocks(30), 0u) << "only with all that are to come";
  pass(1);
  EXPECT_EQ(max_missing_blocks(30), 30u);
  plan_.record_draw(100, 2000, 1, now_);
  pass(200);
  EXPECT_EQ(max_missing_blocks(1), 1u);
}

TEST_F(ViewPlanTest, TheFirstFrameAtRestWaitsAMomentForItsBlocks) {
  update(/*moving=*/false);
  EXPECT_EQ(max_missing_blocks(10), 0u);
  pass(499);
  EXPECT_EQ(max_missing_blocks(10), 0u);
  pass(1);
  EXPECT_EQ(max_missing_blocks(10), kAny) << "none came: what is there is shown";
}

TEST_F(ViewPlanTest, TheFirstFrameAtRestWaitsForHalfOfItsBlocks) {
  update(/*moving=*/false);
  pass(600);
  EXPECT_EQ(plan_.max_missing_blocks(now_), 0u) << "nobody knows yet how many are missing";
  update(/*moving=*/false);
  EXPECT_EQ(max_missing_blocks(97, 98), 0u);
  pass(2499);
  EXPECT_EQ(max_missing_blocks(50, 98), 0u) << "it would show little more than the frame in motion";
  EXPECT_EQ(max_missing_blocks(48, 98), 0u) << "the others come soon";
  EXPECT_EQ(max_missing_blocks(49, 98), kAny) << "that many do not";
  EXPECT_EQ(max_missing_blocks(97, 98), 0u);
  pass(1);
  EXPECT_EQ(max_missing_blocks(97, 98), kAny) << "not for ever";
}

TEST_F(ViewPlanTest, TheFirstFrameAtRestWaitsForAllBlocksThatComeSoon) {
  update(/*moving=*/false);
  EXPECT_EQ(max_missing_blocks(700), 0u);
  pass(1000);
  EXPECT_EQ(max_missing_blocks(500), 0u) << "200 in 1000 ms: 500 more take 2500 ms";
  EXPECT_EQ(max_missing_blocks(510), kAny) << "190 in 1000 ms: 510 more take too long";
  pass(1000);
  EXPECT_EQ(max_missing_blocks(100), 0u) << "600 in 2000 ms: the last 100 take 333 ms";
  plan_.record_draw(/*draw_ms=*/100, /*blocks=*/2000, /*missing=*/0, now_);
  update(/*moving=*/false);
  EXPECT_EQ(max_missing_blocks(700), 0u);
  pass(600);
  EXPECT_EQ(max_missing_blocks(400), kAny) << "300 in 600 ms: 400 more take 800 ms, and drawing 100";
  pass(600);
  EXPECT_EQ(max_missing_blocks(100), 0u) << "600 in 1200 ms: 100 more take 200 ms";
  update(/*moving=*/false);
  EXPECT_EQ(max_missing_blocks(500), 0u) << "another picture";
  pass(500);
  EXPECT_EQ(max_missing_blocks(500), kAny);
}

TEST_F(ViewPlanTest, BlocksThatComeSoonerThanAFrameIsDrawnAreWaitedFor) {
  update(/*moving=*/false);
  plan_.record_draw(/*draw_ms=*/500, /*blocks=*/2000, /*missing=*/700, now_);
  pass(1200);
  EXPECT_EQ(max_missing_blocks(100), 0u) << "600 in 1200 ms: the last 100 take 200 ms";
  EXPECT_EQ(max_missing_blocks(400), 525u) << "300 in 1200 ms: 400 more take 1600 ms";
  EXPECT_EQ(max_missing_blocks(700), 525u) << "none came";
}

TEST_F(ViewPlanTest, APictureOfMoreBlocksThanItsSurveyIsExpectedToTakeLonger) {
  update(/*moving=*/false);
  plan_.record_draw(/*draw_ms=*/400, /*blocks=*/100, /*missing=*/60, now_);
  pass(1199);
  EXPECT_EQ(max_missing_blocks(30, 150), 0u) << "600 ms, two of them pass first";
  pass(1);
  EXPECT_EQ(max_missing_blocks(29, 150), 0u) << "31 in 1200 ms: 29 more come sooner than the picture is drawn";
  EXPECT_EQ(max_missing_blocks(30, 150), 45u);
  pass(399);
  EXPECT_EQ(max_missing_blocks(45, 10000), 0u) << "800 ms: pixels take their time whatever covers them";
  pass(1);
  EXPECT_EQ(max_missing_blocks(45, 10000), 45u);
}

TEST_F(ViewPlanTest, BlocksThatArriveSlowlyAreNotGivenUp) {
  update(/*moving=*/false);
  show(FrameKind::kMotion, FrameResult::kImprovable);
  pass(150);
  show(FrameKind::kRefined, FrameResult::kImprovable);
  for (uint32_t i = 0; i < 20; ++i) {
    pass(3000);
    plan_.record_missing(100 - i, 1000, now_);
    show(FrameKind::kRefined, FrameResult::kNothing);
  }
  pass(50);
  EXPECT_EQ(drawn(), FrameKind::kRefined);
}

TEST_F(ViewPlanTest, ABusyServerIsGivenTimeBetweenTwoTries) {
  update(/*moving=*/true);
  for (int i = 0; i < 3; ++i) {
    plan_.refuse(begin(FrameKind::kMotion), now_);
    EXPECT_EQ(asked_in(), 500);
    pass(400);
    update(/*moving=*/true);
    EXPECT_EQ(asked_in(), 100) << "however often the hand moves";
    pass(100);
  }
  show(FrameKind::kMotion);
}

TEST_F(ViewPlanTest, AFirstFrameWithNothingOnItIsTriedAgain) {
  update(/*moving=*/false);
  draw_and_send(FrameKind::kMotion, FrameResult::kNothing);
  EXPECT_EQ(asked_in(), 50);
  pass(50);
  show(FrameKind::kMotion);
}

TEST_F(ViewPlanTest, PiecesOnTheirWayDelayTheSendingOfAMotionButNotItsDrawing) {
  update(/*moving=*/false);
  show(FrameKind::kMotion);
  pass(150);
  const uint64_t fine = begin(FrameKind::kRefined);
  plan_.finish(fine, FrameResult::kComplete, now_);
  plan_.send(FrameKind::kRefined, /*last=*/false);
  plan_.send(FrameKind::kRefined, /*last=*/false);
  pass(10'000);
  EXPECT_EQ(drawn(), std::nullopt) << "the rest of it comes first";
  update(/*moving=*/true);
  plan_.stop_sending();
  EXPECT_EQ(drawn(), FrameKind::kMotion);
  EXPECT_FALSE(plan_.may_send());
  plan_.acknowledge(FrameKind::kRefined);
  EXPECT_TRUE(plan_.may_send());
}

TEST_F(ViewPlanTest, MoreAnswersThanFramesDoNotMatter) {
  update(/*moving=*/true);
  show(FrameKind::kMotion);
  for (int i = 0; i < 10; ++i) plan_.acknowledge(FrameKind::kMotion);
  update(/*moving=*/true);
  draw_and_send(FrameKind::kMotion);
  update(/*moving=*/true);
  draw_and_send(FrameKind::kMotion);
  EXPECT_FALSE(plan_.may_send());
}

TEST_F(ViewPlanTest, ANewerEditionTakesOverOnceThePictureAtRestIsDrawn) {
  update(/*moving=*/false);
  show(FrameKind::kMotion);
  plan_.expect_takeover();
  pass(150);
  show(FrameKind::kRefined);  // from the present edition, which is quick
  pass(50);
  show(FrameKind::kTakeover);
  pass(300);
  show(FrameKind::kFinal);
  EXPECT_EQ(drawn(), std::nullopt);
}

TEST_F(ViewPlanTest, ANewerEditionThatComesAfterTheFinalPictureTakesOverToo) {
  update(/*moving=*/false);
  show(FrameKind::kMotion);
  pass(150);
  show(FrameKind::kRefined);
  pass(350);
  show(FrameKind::kFinal);
  pass(10'000);
  EXPECT_EQ(drawn(), std::nullopt);
  plan_.expect_takeover();
  show(FrameKind::kTakeover);
  show(FrameKind::kFinal);
  EXPECT_EQ(drawn(), std::nullopt);
}

TEST_F(ViewPlanTest, ATakeoverIsAskedForAgainUntilItsBlocksAreThere) {
  update(/*moving=*/false);
  show(FrameKind::kMotion);
  pass(150);
  show(FrameKind::kRefined);
  plan_.expect_takeover();
  pass(50);
  for (int i = 0; i < 200; ++i) {  // however long it takes
    draw_and_send(FrameKind::kTakeover, FrameResult::kNothing);
    EXPECT_EQ(asked_in(), 50);
    pass(50);
  }
  show(FrameKind::kTakeover);
  show(FrameKind::kFinal);
}

TEST_F(ViewPlanTest, AMotionIsTriedFromTheNewerEditionNowAndThen) {
  EXPECT_FALSE(plan_.may_try_takeover(now_));
  plan_.expect_takeover();
  EXPECT_TRUE(plan_.may_try_takeover(now_));
  plan_.try_takeover(now_);
  pass(249);
  EXPECT_FALSE(plan_.may_try_takeover(now_));
  pass(1);
  EXPECT_TRUE(plan_.may_try_takeover(now_));
  plan_.taken_over();
  EXPECT_FALSE(plan_.may_try_takeover(now_));
}

TEST_F(ViewPlanTest, AMotionComesBeforeATakeoverWhichFollowsWhenItEnds) {
  update(/*moving=*/false);
  show(FrameKind::kMotion);
  pass(150);
  show(FrameKind::kRefined);
  plan_.expect_takeover();
  pass(50);
  const uint64_t takeover = begin(FrameKind::kTakeover);
  update(/*moving=*/true);
  EXPECT_EQ(plan_.outdated(), std::vector<uint64_t>{takeover});
  plan_.drop(takeover);
  show(FrameKind::kMotion);
  update(/*moving=*/false, /*changed=*/false);
  pass(150);
  show(FrameKind::kRefined);
  pass(50);
  EXPECT_EQ(drawn(), FrameKind::kTakeover);
}

}  // namespace
}  // namespace surfcast::view
