#include "service/draw_shares.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::service {
namespace {

/// Simulates a render thread with a simulated clock, a still picture in batches, and moving views.
class RenderThread {
 public:
  struct Mover {
    double draw_ms = 20;      ///< time to draw a frame
    double pause_ms = 0;      ///< from the end of a frame to the next request
    double wanted_since = 0;  ///< time of the current request
    double longest_wait = 0;  ///< of its frames
    int frames = 0;
  };

  explicit RenderThread(std::vector<Mover> hands) : movers(std::move(hands)) {}

  /// Draws motion frames for `ms` while no still picture waits.
  void move(double ms) {
    for (const double end = now + ms; now < end;) {
      if (!draw_motion(WaitingStills::kNone)) now += 1;
    }
  }
  /// Draws a still picture that takes `work_ms` alone. Returns the time that it took.
  double rest(double work_ms, WaitingStills size = WaitingStills::kLarge) {
    const double begin = now;
    while (work_ms > 0) {
      const double batch = std::min(kBatchMs, work_ms);
      now += batch;
      work_ms -= batch;
      shares.drew_other(batch);
      while (shares.motion_first() && draw_motion(size)) {
      }
    }
    return now - begin;
  }

  static constexpr double kBatchMs = 8;
  DrawShares shares;
  std::vector<Mover> movers;
  double now = 0;

 private:
  /// Draws the frame that has waited longest. False if no view requests one.
  bool draw_motion(WaitingStills stills) {
    Mover& mover = *std::ranges::min_element(movers, {}, &Mover::wanted_since);
    if (mover.wanted_since > now) return false;
    mover.longest_wait = std::max(mover.longest_wait, now - mover.wanted_since);
    now += mover.draw_ms;
    ++mover.frames;
    mover.wanted_since = now + mover.pause_ms;
    shares.drew_motion(mover.draw_ms, stills);
    return true;
  }
};

TEST(DrawShares, AMotionGoesFirstWhenNobodyIsOwedAnything) {
  const DrawShares shares;
  EXPECT_TRUE(shares.motion_first());
}

TEST(DrawShares, WhoMovesAloneOwesNobody) {
  DrawShares shares;
  for (int i = 0; i < 1000; ++i) shares.drew_motion(20, WaitingStills::kNone);
  EXPECT_TRUE(shares.motion_first());
}

TEST(DrawShares, AMotionWaitsForABatchAndNotForThePictureThatTakesSeconds) {
  RenderThread thread({{.draw_ms = 15, .pause_ms = 18}});
  thread.rest(5000);
  EXPECT_LE(thread.movers[0].longest_wait, 2 * RenderThread::kBatchMs);
  EXPECT_GE(thread.movers[0].frames, 150);
}

TEST(DrawShares, APictureAtRestBesideOneThatNeverStopsTakesFourTimesItsLength) {
  RenderThread thread({{.draw_ms = 20, .pause_ms = 0}});
  thread.move(60'000);
  const double took = thread.rest(3000);
  EXPECT_GE(took, 3.5 * 3000);
  EXPECT_LE(took, 4.2 * 3000);
}

TEST(DrawShares, ASmallPictureAtRestBesideOneThatNeverStopsTakesTwiceItsLength) {
  RenderThread thread({{.draw_ms = 20, .pause_ms = 0}});
  thread.move(60'000);
  EXPECT_LE(thread.rest(300, WaitingStills::kSmall), 2 * 300 + 100);
}

TEST(DrawShares, ASmallPictureAtRestBesideExpensiveFramesTakesTwiceItsLengthAndOneOfThem) {
  RenderThread thread({{.draw_ms = 400, .pause_ms = 0}});
  thread.move(60'000);
  EXPECT_LE(thread.rest(900, WaitingStills::kSmall), 2 * 900 + 400);
}

TEST(DrawShares, ManyWhoMoveLeaveAsMuchToOneWhoRests) {
  RenderThread thread(std::vector<RenderThread::Mover>(12, {.draw_ms = 25, .pause_ms = 5}));
  EXPECT_LE(thread.rest(1000), 4.2 * 1000);
  const auto [least, most] = std::ranges::minmax_element(thread.movers, {}, &RenderThread::Mover::frames);
  EXPECT_LE(most->frames - least->frames, 1);
}

TEST(DrawShares, ALongRestDoesNotHoldUpTheMotionThatFollows) {
  RenderThread thread({{.draw_ms = 20, .pause_ms = 15, .wanted_since = 30'000}});
  thread.rest(60'000);
  EXPECT_LE(thread.movers[0].longest_wait, 2 * RenderThread::kBatchMs);
}

TEST(DrawShares, AnExpensiveFrameDoesNotStopTheMotionForLong) {
  RenderThread thread({{.draw_ms = 2000, .pause_ms = 1}});
  thread.rest(1000);
  EXPECT_LE(thread.movers[0].longest_wait, 100);
}

}  // namespace
}  // namespace surfcast::service
