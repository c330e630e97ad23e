#include "view/quality_controller.h"

#include <algorithm>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::view {
namespace {

/// A simulated machine: the cost of a frame by its quality.
using Machine = std::function<MotionCost(const MotionQuality&)>;

/// Drawing takes `full_ms` for a full-size picture at a spacing of one pixel, most of it for splats, and at least
/// `least_ms`.
Machine renderer(double full_ms, double least_ms = 1) {
  return [=](const MotionQuality& q) {
    const double pixels = q.scale * q.scale;
    return MotionCost{least_ms + full_ms * pixels * (1 + 10 / (q.spacing * q.spacing)) / 11, 1, 0.1, 1};
  };
}

Machine line(double full_ms) {
  return [=](const MotionQuality& q) {
    return MotionCost{2, 1, full_ms * q.scale * q.scale * q.jpeg_quality / 85.0, 1};
  };
}

struct Ride {
  QualityState state = first_quality();
  std::vector<MotionQuality> shown;

  void frames(const Machine& machine, int count, double fps = 30) {
    for (int i = 0; i < count; ++i) {
      shown.push_back(quality_of(state));
      state = adapt(state, machine(shown.back()), fps);
    }
  }
  /// The number of changes of quality among the last frames.
  [[nodiscard]] int changes(size_t last) const {
    int count = 0;
    for (size_t i = shown.size() - last + 1; i < shown.size(); ++i) {
      count += shown[i].scale != shown[i - 1].scale || shown[i].spacing != shown[i - 1].spacing ||
               shown[i].jpeg_quality != shown[i - 1].jpeg_quality;
    }
    return count;
  }
};

TEST(QualityController, AFastMachineGetsTheWholePicture) {
  Ride run;
  run.frames(renderer(10), 100);
  EXPECT_EQ(run.shown.back().scale, 1);
  EXPECT_EQ(run.shown.back().spacing, 1);
  EXPECT_EQ(run.shown.back().jpeg_quality, 85);
}

TEST(QualityController, ASlowRendererGetsSmallerAndCoarserPicturesThatKeepTheRate) {
  const Machine slow = renderer(600);
  Ride run;
  run.frames(slow, 100);
  EXPECT_LT(run.shown.back().scale, 0.6);
  EXPECT_LE(slow(run.shown.back()).draw, 1000.0 / 30);
}

TEST(QualityController, LittleOfTheTimeOfAFrameIsLeftOver) {
  // From machines that are fast enough for full quality to those that are too slow for the cheapest rung.
  for (double full = 40; full < 1500; full *= 1.07) {
    const Machine machine = renderer(full);
    Ride run;
    run.frames(machine, 1000);
    const double ms = machine(run.shown.back()).draw;
    EXPECT_LE(ms, 1000.0 / 30) << full;
    EXPECT_GE(ms, 0.5 * 1000.0 / 30) << full;
  }
}

TEST(QualityController, ItTakesFewFramesToGetThere) {
  const Machine slow = renderer(900);
  Ride run;
  run.frames(slow, 7);
  EXPECT_LE(slow(quality_of(run.state)).draw, 1000.0 / 30);
}

TEST(QualityController, ASlowLineGetsFewerBytesAndNoCoarserSurfels) {
  const Machine thin = line(400);
  Ride run;
  run.frames(thin, 100);
  EXPECT_LE(thin(run.shown.back()).transfer, 1000.0 / 30);
  EXPECT_LT(run.shown.back().jpeg_quality, 85);
  EXPECT_EQ(run.shown.back().spacing, 1) << "the renderer is fast";
}

TEST(QualityController, ASlowClientGetsSmallerPictures) {
  const Machine client = [](const MotionQuality& q) { return MotionCost{2, 1, 0.1, 100 * q.scale * q.scale}; };
  Ride run;
  run.frames(client, 100);
  EXPECT_LE(client(run.shown.back()).client, 1000.0 / 30);
}

TEST(QualityController, NothingHelpsTheSlowestButItStaysWithinBounds) {
  Ride run;
  run.frames([](const MotionQuality&) { return MotionCost{5000, 5000, 5000, 5000}; }, 300);
  EXPECT_GE(run.shown.back().scale, 0.2);
  EXPECT_LE(run.shown.back().spacing, 4);
  EXPECT_GE(run.shown.back().jpeg_quality, 30);
}

TEST(QualityController, FramesOfAVideoLeaveTheLinksLadderAsItIs) {
  QualityState state = first_quality();
  for (int i = 0; i < 100; ++i) state = adapt_drawing(state, {.draw = 1, .transfer = 1000}, 30);
  EXPECT_EQ(state.link.rung, first_quality().link.rung);
  EXPECT_EQ(state.draw.rung, 0U);
  state.link.rung = 7;
  EXPECT_LT(quality_of(state).scale, 1);
  EXPECT_EQ(drawing_of(state).scale, 1);
}

TEST(QualityController, AHigherRateCostsQuality) {
  Ride slow;
  slow.frames(renderer(100), 200, 15);
  Ride fast;
  fast.frames(renderer(100), 200, 60);
  EXPECT_GT(slow.shown.back().scale, fast.shown.back().scale);
}

TEST(QualityController, AMachineBetweenTwoRungsDoesNotMakeItSwing) {
  for (double full = 5; full < 3000; full *= 1.13) {
    Ride run;
    run.frames(renderer(full), 600);
    EXPECT_LE(run.changes(300), 2) << full;
  }
}

TEST(QualityController, AMachineThatIsDearerThanItsRungsSayDoesNotMakeItSwing) {
  // The extrapolated cost of each better rung is affordable, but the real cost is not.
  const Machine steep = [](const MotionQuality& q) { return MotionCost{q.scale > 0.4 ? 60.0 : 8.0, 1, 0.1, 1}; };
  Ride run;
  run.frames(steep, 3000);
  EXPECT_LE(run.changes(1000), 12);
}

TEST(QualityController, FramesThatTakeTurnsInCostingMoreDoNotMakeItSwing) {
  int frame = 0;
  const Machine uneven = [&frame](const MotionQuality& q) {
    return MotionCost{renderer(60)(q).draw * (++frame % 2 == 0 ? 1.3 : 0.8), 1, 0.1, 1};
  };
  Ride run;
  run.frames(uneven, 600);
  EXPECT_LE(run.changes(300), 4);
}

TEST(QualityController, FramesThatVaryGetTheQualityOfTheirMean) {
  // Other work on the machine: one frame in four takes twice as long, and two such frames in a row are common.
  int frame = 0;
  const Machine disturbed = [&frame](const MotionQuality& q) {
    const uint32_t random = static_cast<uint32_t>(++frame) * 2654435761U;
    return MotionCost{renderer(60)(q).draw * (random >> 30 == 0 ? 1.6 : 0.8), 1, 0.1, 1};
  };
  Ride run;
  run.frames(disturbed, 600);
  double sum = 0;
  for (size_t i = 300; i < 600; ++i) sum += disturbed(run.shown[i]).draw;
  EXPECT_LE(sum / 300, 1000.0 / 30);
  EXPECT_GE(sum / 300, 0.6 * 1000.0 / 30);
}

TEST(QualityController, OneFrameThatTakesLongChangesNothing) {
  Ride run;
  run.frames(renderer(10), 200);
  run.frames([](const MotionQuality&) { return MotionCost{900, 1, 900, 1}; }, 1);
  run.frames(renderer(10), 10);
  EXPECT_EQ(run.changes(11), 0);
}

TEST(QualityController, AfterAStallTheQualityComesBack) {
  Ride run;
  run.frames(renderer(10), 200);
  run.frames([](const MotionQuality&) { return MotionCost{900, 1, 900, 1}; }, 20);
  EXPECT_LT(run.shown.back().scale, 0.5);
  run.frames(renderer(10), 120);
  EXPECT_EQ(run.shown.back().scale, 1);
}

}  // namespace
}  // namespace surfcast::view
