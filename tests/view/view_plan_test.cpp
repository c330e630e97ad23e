#include "view/view_plan.h"

#include <limits>

#include <gtest/gtest.h>

namespace surfcast {
namespace {

using std::chrono::milliseconds;

/// A plan, a clock that the test moves, and a client that answers when it is told to.
class ViewPlanTest : public ::testing::Test {
 protected:
  void update(bool moving, bool changed = true) { plan_.update(changed, moving, now_); }
  void pass(int ms) { now_ += milliseconds(ms); }

  /// What is to be drawn now.
  [[nodiscard]] std::optional<FrameKind> drawn() const { return plan_.next(now_).draw; }
  /// Milliseconds until the plan wants to be asked again; -1: it waits for an event.
  [[nodiscard]] long asked_in() const {
    const ViewStep step = plan_.next(now_);
    return step.look_again ? std::chrono::duration_cast<milliseconds>(*step.look_again - now_).count() : -1;
  }
  uint64_t begin(FrameKind kind) {
    EXPECT_EQ(drawn(), kind);
    plan_.begin(++frame_, kind);
    return frame_;
  }
  /// From the beginning of a frame to its arrival at the client.
  void draw_and_send(FrameKind kind, FrameNews news = FrameNews::kComplete) {
    const uint64_t frame = begin(kind);
    plan_.finish(frame, news, now_);
    if (news != FrameNews::kNothing) plan_.send(kind, /*last=*/true);
  }
  void show(FrameKind kind, FrameNews news = FrameNews::kComplete) {
    draw_and_send(kind, news);
    if (news != FrameNews::kNothing) plan_.acknowledge(kind);
  }

  static constexpr uint32_t kAny = std::numeric_limits<uint32_t>::max();
  /// The most blocks that a frame at rest may miss to be drawn, after a look that missed so many.
  uint32_t most_missing(uint32_t missing) {
    plan_.look(missing, now_);
    return plan_.most_missing(now_);
  }

  ViewPlan plan_{ViewTiming{}};
  ViewTime now_ = ViewTime{} + std::chrono::hours(1);
  uint64_t frame_ = 0;
};

TEST_F(ViewPlanTest, APictureAtRestIsDrawnQuicklyThenFinelyThenFinallyAndNeverAgain) {
  update(/*moving=*/false);
  show(FrameKind::kQuick);
  EXPECT_EQ(asked_in(), 150);
  pass(150);
  show(FrameKind::kFine);
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
  show(FrameKind::kQuick);
  EXPECT_EQ(asked_in(), 250 + 150);
}

TEST_F(ViewPlanTest, TheEndOfAMotionCountsFromItsLastMovement) {
  update(/*moving=*/true);
  show(FrameKind::kQuick);
  pass(100);
  update(/*moving=*/false, /*changed=*/false);
  EXPECT_EQ(asked_in(), 50);
}

TEST_F(ViewPlanTest, AnUpdateThatShowsNothingElseStopsNothing) {
  update(/*moving=*/false);
  show(FrameKind::kQuick);
  pass(150);
  begin(FrameKind::kFine);
  update(/*moving=*/false, /*changed=*/false);
  EXPECT_TRUE(plan_.outdated().empty());
  EXPECT_EQ(drawn(), std::nullopt);
}

TEST_F(ViewPlanTest, AFrameIsDrawnWhileTheLastOneIsOnItsWay) {
  update(/*moving=*/true);
  draw_and_send(FrameKind::kQuick);
  update(/*moving=*/true);
  draw_and_send(FrameKind::kQuick);
  update(/*moving=*/true);
  EXPECT_EQ(drawn(), std::nullopt) << "two are on their way";
  EXPECT_FALSE(plan_.may_send());
  EXPECT_EQ(asked_in(), -1) << "only the client can change that";
  plan_.acknowledge(FrameKind::kQuick);
  EXPECT_EQ(drawn(), FrameKind::kQuick);
}

TEST_F(ViewPlanTest, TheNewestUpdateTakesThePlaceOfOneThatWaits) {
  update(/*moving=*/true);
  begin(FrameKind::kQuick);
  update(/*moving=*/true);
  const uint64_t waiting = begin(FrameKind::kQuick);
  EXPECT_EQ(plan_.renewable(), std::nullopt) << "it shows the newest";
  update(/*moving=*/true);
  EXPECT_EQ(plan_.renewable(), waiting);
  plan_.renew(waiting);
  EXPECT_EQ(plan_.renewable(), std::nullopt);
  EXPECT_EQ(drawn(), std::nullopt) << "the newest is taken care of";
}

TEST_F(ViewPlanTest, AnUpdateOutdatesFramesAtRest) {
  update(/*moving=*/false);
  show(FrameKind::kQuick);
  pass(150);
  const uint64_t fine = begin(FrameKind::kFine);
  update(/*moving=*/true);
  EXPECT_EQ(plan_.outdated(), std::vector<uint64_t>{fine});
  plan_.drop(fine);
  EXPECT_FALSE(plan_.expects(fine));
  EXPECT_EQ(drawn(), FrameKind::kQuick) << "at once";
  plan_.finish(fine, FrameNews::kComplete, now_);
  EXPECT_EQ(drawn(), FrameKind::kQuick) << "what comes of it late does not matter";
}

TEST_F(ViewPlanTest, AnOlderFrameDoesNotPassForTheNewestPicture) {
  update(/*moving=*/false);
  const uint64_t old = begin(FrameKind::kQuick);
  update(/*moving=*/false);
  plan_.finish(old, FrameNews::kComplete, now_);
  plan_.send(FrameKind::kQuick, true);
  EXPECT_EQ(drawn(), FrameKind::kQuick);
}

TEST_F(ViewPlanTest, BlocksThatComeAreDrawnUntilNoneIsMissing) {
  update(/*moving=*/false);
  show(FrameKind::kQuick, FrameNews::kImproves);
  pass(150);
  show(FrameKind::kFine, FrameNews::kImproves);
  EXPECT_EQ(asked_in(), 50);
  for (int i = 0; i < 20; ++i) {
    pass(50);
    show(FrameKind::kFine, i % 2 == 0 ? FrameNews::kNothing : FrameNews::kImproves);
  }
  pass(50);
  show(FrameKind::kFine, FrameNews::kComplete);
  show(FrameKind::kFinal);
}

TEST_F(ViewPlanTest, BlocksThatNeverComeDoNotKeepItFromTheFinalFrame) {
  update(/*moving=*/false);
  show(FrameKind::kQuick, FrameNews::kImproves);
  pass(150);
  show(FrameKind::kFine, FrameNews::kImproves);
  int looks = 0;
  for (; looks < 1000 && asked_in() == 50; ++looks) {
    pass(50);
    show(FrameKind::kFine, FrameNews::kNothing);
  }
  EXPECT_LT(looks, 110);
  EXPECT_EQ(drawn(), FrameKind::kFinal);
}

/// A picture at rest of a large model: blocks arrive at a rate, drawing takes longer the more are there.
struct LargeModel {
  uint32_t blocks = 1000;
  double blocks_per_ms = 0.1;
  double draw_ms = 4000;  ///< of all blocks
};

TEST_F(ViewPlanTest, FewFramesAreDrawnWhileBlocksArrive) {
  const LargeModel model;
  update(/*moving=*/false);
  show(FrameKind::kQuick, FrameNews::kImproves);
  const ViewTime rest = now_;
  pass(150);
  double work_ms = 0;
  int drawn_frames = 0;
  for (;;) {
    const double ms = std::chrono::duration<double, std::milli>(now_ - rest).count();
    const auto come = std::min(model.blocks, static_cast<uint32_t>(ms * model.blocks_per_ms));
    const uint32_t missing = model.blocks - come;
    const uint64_t frame = begin(FrameKind::kFine);
    plan_.look(missing, now_);
    const bool worth = drawn_frames == 0 || missing == 0 || missing <= plan_.most_missing(now_);
    if (worth) {
      const double draw_ms = model.draw_ms * come / model.blocks;
      now_ += std::chrono::microseconds(static_cast<long>(1000 * draw_ms));
      plan_.drew(draw_ms, missing, now_);
      work_ms += draw_ms;
      ++drawn_frames;
    }
    plan_.finish(frame, missing == 0 ? FrameNews::kComplete : FrameNews::kNothing, now_);
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
  plan_.drew(/*draw_ms=*/100, /*missing=*/40, now_);
  pass(199);
  EXPECT_EQ(most_missing(30), 0u) << "only with all that are to come";
  pass(1);
  EXPECT_EQ(most_missing(30), 30u);
  plan_.drew(100, 1, now_);
  pass(200);
  EXPECT_EQ(most_missing(1), 1u);
}

TEST_F(ViewPlanTest, TheFirstFrameAtRestWaitsAMomentForItsBlocks) {
  update(/*moving=*/false);
  EXPECT_EQ(most_missing(10), 0u);
  pass(499);
  EXPECT_EQ(most_missing(10), 0u);
  pass(1);
  EXPECT_EQ(most_missing(10), kAny) << "none came: what is there is shown";
}

TEST_F(ViewPlanTest, TheFirstFrameAtRestWaitsForAllBlocksThatComeSoon) {
  update(/*moving=*/false);
  EXPECT_EQ(most_missing(700), 0u);
  pass(1000);
  EXPECT_EQ(most_missing(500), 0u) << "200 in 1000 ms: 500 more take 2500 ms";
  EXPECT_EQ(most_missing(510), kAny) << "190 in 1000 ms: 510 more take too long";
  pass(1000);
  EXPECT_EQ(most_missing(100), 0u) << "600 in 2000 ms: the last 100 take 333 ms";
  plan_.drew(/*draw_ms=*/100, /*missing=*/0, now_);
  update(/*moving=*/false);
  EXPECT_EQ(most_missing(700), 0u);
  pass(600);
  EXPECT_EQ(most_missing(400), kAny) << "300 in 600 ms: 400 more take 800 ms, and drawing 100";
  pass(600);
  EXPECT_EQ(most_missing(100), 0u) << "600 in 1200 ms: 100 more take 200 ms";
  update(/*moving=*/false);
  EXPECT_EQ(most_missing(500), 0u) << "another picture";
  pass(500);
  EXPECT_EQ(most_missing(500), kAny);
}

TEST_F(ViewPlanTest, BlocksThatComeSoonerThanAFrameIsDrawnAreWaitedFor) {
  update(/*moving=*/false);
  plan_.drew(/*draw_ms=*/500, /*missing=*/700, now_);
  pass(1200);
  EXPECT_EQ(most_missing(100), 0u) << "600 in 1200 ms: the last 100 take 200 ms";
  EXPECT_EQ(most_missing(400), 525u) << "300 in 1200 ms: 400 more take 1600 ms";
  EXPECT_EQ(most_missing(700), 525u) << "none came";
}

TEST_F(ViewPlanTest, BlocksThatArriveSlowlyAreNotGivenUp) {
  update(/*moving=*/false);
  show(FrameKind::kQuick, FrameNews::kImproves);
  pass(150);
  show(FrameKind::kFine, FrameNews::kImproves);
  for (uint32_t i = 0; i < 20; ++i) {
    pass(3000);
    plan_.look(100 - i, now_);
    show(FrameKind::kFine, FrameNews::kNothing);
  }
  pass(50);
  EXPECT_EQ(drawn(), FrameKind::kFine);
}

TEST_F(ViewPlanTest, ABusyServerIsGivenTimeBetweenTwoTries) {
  update(/*moving=*/true);
  for (int i = 0; i < 3; ++i) {
    plan_.refuse(begin(FrameKind::kQuick), now_);
    EXPECT_EQ(asked_in(), 500);
    pass(400);
    update(/*moving=*/true);
    EXPECT_EQ(asked_in(), 100) << "however often the hand moves";
    pass(100);
  }
  show(FrameKind::kQuick);
}

TEST_F(ViewPlanTest, AFirstFrameWithNothingOnItIsTriedAgain) {
  update(/*moving=*/false);
  draw_and_send(FrameKind::kQuick, FrameNews::kNothing);
  EXPECT_EQ(asked_in(), 50);
  pass(50);
  show(FrameKind::kQuick);
}

TEST_F(ViewPlanTest, PiecesOnTheirWayDelayTheSendingOfAMotionButNotItsDrawing) {
  update(/*moving=*/false);
  show(FrameKind::kQuick);
  pass(150);
  const uint64_t fine = begin(FrameKind::kFine);
  plan_.finish(fine, FrameNews::kComplete, now_);
  plan_.send(FrameKind::kFine, /*last=*/false);
  plan_.send(FrameKind::kFine, /*last=*/false);
  pass(10'000);
  EXPECT_EQ(drawn(), std::nullopt) << "the rest of it comes first";
  update(/*moving=*/true);
  plan_.stop_sending();
  EXPECT_EQ(drawn(), FrameKind::kQuick);
  EXPECT_FALSE(plan_.may_send());
  plan_.acknowledge(FrameKind::kFine);
  EXPECT_TRUE(plan_.may_send());
}

TEST_F(ViewPlanTest, MoreAnswersThanFramesDoNotMatter) {
  update(/*moving=*/true);
  show(FrameKind::kQuick);
  for (int i = 0; i < 10; ++i) plan_.acknowledge(FrameKind::kQuick);
  update(/*moving=*/true);
  draw_and_send(FrameKind::kQuick);
  update(/*moving=*/true);
  draw_and_send(FrameKind::kQuick);
  EXPECT_FALSE(plan_.may_send());
}

}  // namespace
}  // namespace surfcast
