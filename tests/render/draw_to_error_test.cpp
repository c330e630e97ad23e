#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "render/draw_to_goal.h"
#include "render/sampled_error.h"

namespace surfcast::render {
namespace {

constexpr int kWidth = 1024;
constexpr int kHeight = 512;
constexpr int kStep = 16;  // levels by which a wrong pixel differs
constexpr double kBusy = 0.25;

/// In the unit interval, one number for each pixel.
double noise(int x, int y) {
  uint32_t h = static_cast<uint32_t>(x) * 0x9E3779B1U ^ static_cast<uint32_t>(y) * 0x85EBCA77U;
  h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12)) * 0x297A2D39U;
  return static_cast<double>(h ^ (h >> 15)) / 4294967296.0;
}

/// The share of the pixels in the left quarter that are wrong. Elsewhere all are right.
double wrong_share(double spacing) {
  return std::min(0.1 * std::pow(spacing, 10 / (10 * std::log10(2.0))), 1.0);
}

/// The PSNR of a picture whose left quarter alone is wrong.
double true_psnr(double spacing) {
  return 10 * std::log10(255.0 * 255 / (kBusy * wrong_share(spacing) * kStep * kStep));
}

/// A picture whose error is known: the pixels that are wrong at a spacing are so at all coarser ones.
picture::Frame known_frame(const picture::PictureRequest& request, const std::optional<Region>& window) {
  const Region region = window.value_or(Region{0, 0, request.width, request.height});
  const double spacing = request.spacing * kWidth / request.width;  // of the large picture
  picture::Frame frame;
  frame.spacing = request.spacing;
  frame.image = {region.width, region.height, request.format, {}};
  for (int y = region.y; y < region.y + region.height; ++y) {
    for (int x = region.x; x < region.x + region.width; ++x) {
      const bool wrong = x < kBusy * request.width && noise(x, y) < wrong_share(spacing);
      const auto level = static_cast<std::byte>(wrong ? 100 + kStep : 100);
      frame.image.pixels.insert(frame.image.pixels.end(), {level, level, level, std::byte{255}});
    }
  }
  frame.stats.stages = {{"load", 1000}, {"splat", 1}};
  return frame;
}

picture::PictureRequest request_of(double error) {
  picture::PictureRequest request;
  request.width = kWidth;
  request.height = kHeight;
  request.error = error;
  return request;
}

/// The model, which notes what is drawn.
struct Drawn {
  int wholes = 0;
  double pixels = 0;
  std::set<double> budgets;

  DrawWindow draw() {
    return [this](const picture::PictureRequest& request, const std::optional<Region>& window) {
      picture::Frame frame = known_frame(request, window);
      wholes += int{!window && request.width == kWidth};
      pixels += static_cast<double>(frame.image.pixels.size()) / 4;
      budgets.insert(request.error + request.time_ms);
      return Result<picture::Frame>(std::move(frame));
    };
  }
};

TEST(DrawToError, ThePictureHasTheErrorThatWasAskedFor) {
  for (const double asked : {30.0, 36.0, 42.0, 48.0, 54.0}) {
    Drawn drawn;
    SpacingGuess guess;
    const Result<picture::Frame> frame = draw_to_error(request_of(asked), drawn.draw(), guess);
    ASSERT_TRUE(frame);
    EXPECT_GE(true_psnr(frame->spacing), asked - 1.5);
    EXPECT_LE(true_psnr(frame->spacing), asked + 4);
    EXPECT_NEAR(frame->expected_error, true_psnr(frame->spacing), 2);
    EXPECT_EQ(guess.found.spacing, frame->spacing) << "the next search begins here";
  }
}

TEST(DrawToError, OnlyTheLastPictureIsDrawnWhole) {
  Drawn drawn;
  SpacingGuess guess;
  const Result<picture::Frame> frame = draw_to_error(request_of(40), drawn.draw(), guess);
  ASSERT_TRUE(frame);
  EXPECT_EQ(drawn.wholes, 1);
  EXPECT_LT(drawn.pixels, 3.0 * kWidth * kHeight);
  EXPECT_EQ(drawn.budgets, std::set<double>{0}) << "what is drawn has a spacing";
  EXPECT_EQ(frame->image.width, kWidth);
  EXPECT_EQ(frame->expected_ms, 1) << "without loading blocks";
  EXPECT_EQ(frame->stats.stages.back().name, "search");
  EXPECT_GT(frame->stats.stages.back().milliseconds, 10);
}

TEST(DrawToError, SmallPicturesAreComparedWhole) {
  picture::PictureRequest request = request_of(40);
  request.width = request.height = 64;
  SpacingGuess guess;
  std::set<int> widths;
  const auto draw = [&](const picture::PictureRequest& part, const std::optional<Region>& window) {
    widths.insert(window ? window->width : part.width);
    return Result<picture::Frame>(known_frame(part, window));
  };
  ASSERT_TRUE(draw_to_error(request, draw, guess));
  EXPECT_EQ(widths, (std::set<int>{16, 64}));
}

TEST(DrawToError, FailsWhereADrawingFails) {
  SpacingGuess guess;
  for (int good = 0; good < 30; good += 7) {
    int drawn = 0;
    const auto draw = [&](const picture::PictureRequest& request, const std::optional<Region>& window) {
      if (drawn++ == good) return Result<picture::Frame>(fail(ErrorKind::kCancelled, "cancelled"));
      return Result<picture::Frame>(known_frame(request, window));
    };
    const Result<picture::Frame> frame = draw_to_error(request_of(40), draw, guess);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(drawn, good + 1);
  }
}

TEST(DrawToError, NothingToSeeIsTheSamePicture) {
  SpacingGuess guess;
  const auto draw = [](const picture::PictureRequest& request, const std::optional<Region>& window) {
    picture::Frame frame = known_frame(request, window);
    std::ranges::fill(frame.image.pixels, std::byte{0});
    return Result<picture::Frame>(std::move(frame));
  };
  const Result<picture::Frame> frame = draw_to_error(request_of(40), draw, guess);
  ASSERT_TRUE(frame);
  EXPECT_TRUE(std::isinf(frame->expected_error));
}

TEST(SampledError, PixelsThatNeitherPictureCoversDoNotCount) {
  picture::Image a{2, 1, picture::PixelFormat::kSrgb8, std::vector<std::byte>(8)};
  picture::Image b = a;
  EXPECT_EQ(compare_pixels(a, b, {0, 0, 2, 1}).pixels, 0);
  b.pixels[3] = std::byte{1};
  b.pixels[0] = std::byte{3};
  b.pixels[4] = std::byte{200};
  const SquaredError error = compare_pixels(a, b, {0, 0, 2, 1});
  EXPECT_EQ(error.pixels, 1);
  EXPECT_EQ(error.squares, 3);
  EXPECT_NEAR(psnr_of(255.0 * 255 / 1e4), 40, 1e-9);
  EXPECT_EQ(psnr_of(0), kSamePicture);
}

/// A small picture of 4 x 4 squares of 16 pixels, with noise of this strength in each.
picture::Image patches(double spacing) {
  picture::PictureRequest request = request_of(0);
  request.width = kWidth / 4;
  request.height = kHeight / 4;
  request.spacing = spacing;
  return known_frame(request, {}).image;
}

TEST(SampledError, WeightsMakeTheSumOverWindowsThatOverThePicture) {
  const ErrorSample sample = choose_windows(patches(0.25), patches(0.5), kWidth, kHeight, 64, 24);
  EXPECT_EQ(sample.covered, kWidth * kHeight);
  double busy = 0;
  double pixels = 0;
  for (const SampledWindow& window : sample.windows) {
    busy += int{window.region.x < kBusy * kWidth};
    if (window.region.x < kBusy * kWidth) pixels += window.weight * window.region.width * window.region.height;
  }
  EXPECT_GT(busy, 0.8 * static_cast<double>(sample.windows.size())) << "most windows are where the error is";
  EXPECT_NEAR(pixels / (kBusy * kWidth * kHeight), 1, 0.15);
}

TEST(DrawToTime, ReturnsThePictureOfTheTimeAndNothingElse) {
  picture::PictureRequest request = request_of(0);
  request.time_ms = 100;
  std::optional<SpacingTime> known;
  const auto draw = [](const picture::PictureRequest& whole) {
    picture::Frame frame;
    frame.spacing = whole.spacing;
    frame.stats.stages = {{"load", 1000}, {"splat", 20 + 300 / std::pow(std::max(whole.spacing, 0.1), 2)}};
    return Result<picture::Frame>(std::move(frame));
  };
  const Result<picture::Frame> frame = draw_to_time(request, draw, known);
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->expected_ms, 100, 25);
  EXPECT_NEAR(frame->expected_ms, 20 + 300 / std::pow(frame->spacing, 2), 1e-9);
  EXPECT_EQ(frame->expected_error, 0) << "not known";
  ASSERT_TRUE(known);
  EXPECT_EQ(known->spacing, frame->spacing);
  const Result<picture::Frame> again = draw_to_time(request, draw, known);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->stats.stages.back().milliseconds, 0) << "the first picture fits";
  request.time_ms = 1e6;
  const Result<picture::Frame> finest = draw_to_time(request, draw, known);
  ASSERT_TRUE(finest);
  EXPECT_EQ(finest->spacing, 0);
  EXPECT_TRUE(std::isinf(finest->expected_error));
}

TEST(DrawToTime, WhereNoSpacingIsFastEnoughThePictureIsDrawnSmaller) {
  picture::PictureRequest request = request_of(0);
  request.time_ms = 100;
  std::optional<SpacingTime> known;
  const auto draw = [](const picture::PictureRequest& whole) {
    picture::Frame frame;
    frame.spacing = whole.spacing;
    frame.render_scale = whole.render_scale;
    frame.stats.stages = {{"splat", 30 + std::pow(whole.render_scale, 2) * (400 + 300 / std::pow(whole.spacing, 2))}};
    return Result<picture::Frame>(std::move(frame));
  };
  const Result<picture::Frame> frame = draw_to_time(request, draw, known);
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->expected_ms, 100, 25);
  EXPECT_LT(frame->render_scale, 0.5);
  EXPECT_GT(frame->spacing, 0);
  request.time_ms = 0;
  request.spacing = frame->spacing;
  request.render_scale = frame->render_scale;
  const Result<picture::Frame> stated = draw(request);
  EXPECT_EQ(drawing_ms(*stated), frame->expected_ms) << "what is stated is what was drawn";
}

}  // namespace
}  // namespace surfcast::render
