#include "view/view_plan.h"

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
