#include "render/spacing_search.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "render/time_search.h"

namespace surfcast::render {
namespace {

/// The PSNR at a spacing.
using ErrorCurve = std::function<double(double spacing)>;

struct Found {
  SpacingError best;
  int trials = 0;
};

Found search_error(const ErrorCurve& curve, double asked) {
  SpacingSearch search(asked);
  int trials = 0;
  for (std::optional<double> next = guessed_spacing({}, asked); next; next = search.next()) {
    search.add({*next, *next == 0 ? kSamePicture : std::min(curve(*next), kSamePicture)});
    ++trials;
  }
  return {search.best(), trials};
}

TEST(SpacingSearch, FindsTheSpacingOnCurvesOfAnyPlaceAndUsualSlope) {
  for (const double place : {0.5, 1.0, 3.0, 12.0}) {
    for (const double slope : {6.0, 10.0, 14.0}) {
      for (const double asked : {25.0, 34.0, 40.0, 46.0, 54.0}) {
        const auto curve = [&](double spacing) { return 40 - slope * std::log2(spacing / place); };
        const Found found = search_error(curve, asked);
        EXPECT_GE(found.best.decibels, asked) << place << " " << slope << " " << asked;
        EXPECT_LE(found.best.decibels, asked + 2.5) << place << " " << slope << " " << asked;
        EXPECT_LE(found.trials, 8);
      }
    }
  }
}

TEST(SpacingSearch, FindsASpacingOnACurveWithAStepAndAFlatPart) {
  const auto curve = [](double spacing) {
    if (spacing < 1.3) return kSamePicture;  // nothing is coarsened
    return spacing < 2 ? 52 - 20 * std::log2(spacing / 1.3) : 39.5 - 3 * std::log2(spacing / 2);
  };
  const Found found = search_error(curve, 42);
  EXPECT_GE(found.best.decibels, 41);
  EXPECT_LE(found.best.decibels, 46);
}

TEST(SpacingSearch, TheFinestLevelIsTakenIfEveryOtherIsTooCoarse) {
  const Found found = search_error([](double) { return 20.0; }, 60);
  EXPECT_EQ(found.best.spacing, 0);
  EXPECT_EQ(found.best.decibels, kSamePicture);
}

TEST(SpacingSearch, EndsWhereEvenTheCoarsestIsFinerThanAsked) {
  const Found found = search_error([](double) { return 50.0; }, 20);
  EXPECT_EQ(found.best.decibels, 50);
  EXPECT_LE(found.trials, 8);
}

TEST(SpacingSearch, EndsWhereNothingDiffers) {
  EXPECT_EQ(search_error([](double) { return kSamePicture; }, 40).best.decibels, kSamePicture);
}

TEST(SpacingSearch, LargerErrorsAskForCoarserPictures) {
  const auto curve = [](double spacing) { return 40 - 10 * std::log2(spacing); };
  double last = 0;
  for (const double asked : {60.0, 50.0, 40.0, 30.0, 20.0}) {
    const double spacing = search_error(curve, asked).best.spacing;
    EXPECT_GT(spacing, last);
    last = spacing;
  }
}

TEST(SpacingSearch, BeginsWhereTheLastOneEnded) {
  const SpacingGuess guess{{3, 41}};
  EXPECT_NEAR(guessed_spacing(guess, 40), 3, 1e-9) << "41 dB are aimed at";
  EXPECT_NEAR(guessed_spacing(guess, 30), 6, 1e-9);
}

using TimeCurve = std::function<double(double spacing)>;

SpacingTime search_time(const TimeCurve& curve, double asked, std::optional<SpacingTime> known = {}) {
  TimeSearch search(asked);
  int trials = 0;
  for (std::optional<double> next = first_spacing_for(known, asked); next; next = search.next()) {
    search.add({*next, curve(*next)});
    EXPECT_LE(++trials, 7);
  }
  return search.best();
}

/// A constant for the pixels, and the surfels: at most those of the model.
TimeCurve cost(double pixels, double surfels, double finest) {
  return [=](double spacing) { return pixels + surfels / std::pow(std::max(spacing, finest), 2); };
}

TEST(TimeSearch, FindsTheSpacingOfATime) {
  for (const double pixels : {10.0, 50.0}) {
    for (const double surfels : {50.0, 200.0, 2000.0}) {
      for (const double asked : {100.0, 200.0, 400.0}) {
        const SpacingTime found = search_time(cost(pixels, surfels, 0.01), asked);
        EXPECT_GE(found.milliseconds, 0.75 * asked) << pixels << " " << surfels << " " << asked;
        EXPECT_LE(found.milliseconds, 1.25 * asked) << pixels << " " << surfels << " " << asked;
      }
    }
  }
}

TEST(TimeSearch, DrawsTheFinestLevelIfThereIsTimeForIt) {
  EXPECT_EQ(search_time(cost(30, 40, 0.8), 400).spacing, 0);
}

TEST(TimeSearch, TakesTheFastestPictureIfNoneIsFastEnough) {
  const auto slow_if_coarse = [](double spacing) { return 500 + 400 / (spacing * spacing) + 40 * spacing; };
  const SpacingTime found = search_time(slow_if_coarse, 100);
  EXPECT_LT(found.milliseconds, 1.1 * slow_if_coarse(std::cbrt(20.0))) << "the minimum of the curve";
}

TEST(TimeSearch, FindsTheSpacingFromAKnownPictureOfAMuchFasterView) {
  const SpacingTime found = search_time(cost(10, 2000, 0.01), 100, SpacingTime{0.5, 90});
  EXPECT_NEAR(found.milliseconds, 100, 25);
}

TEST(TimeSearch, BeginsWithAKnownPicture) {
  EXPECT_NEAR(first_spacing_for(SpacingTime{2, 93}, 100), 2, 1e-9);
  EXPECT_NEAR(first_spacing_for(SpacingTime{2, 93}, 400), 1, 1e-9);
  EXPECT_NEAR(search_time(cost(0, 372, 0.01), 100, SpacingTime{2, 93}).spacing, 2, 1e-9);
}

}  // namespace
}  // namespace surfcast::render
