#include "estimation/stated_radii.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "estimation/make_surfels.h"
#include "scan/shapes.h"

namespace surfcast::estimation {
namespace {

using ::testing::HasSubstr;

constexpr float kNoRadius = std::numeric_limits<float>::quiet_NaN();

using Positions = std::vector<glm::dvec3>;
using RadiusAt = std::function<double(const glm::dvec3&)>;

/// A square lattice of spacing 1 whose points are moved by up to a quarter of it.
Positions moved_lattice(int side) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> move(-0.25, 0.25);
  Positions positions = testing::square_lattice(side, 1, {0, 0, 0});
  for (glm::dvec3& p : positions) {
    p.x += move(random);
    p.y += move(random);
  }
  return positions;
}

/// A plane whose spacing grows along x, from 0.5 to 2, and its spacing at a place.
Positions fading_plane() {
  Positions positions;
  for (double x = 0; x < 75; x += 0.5 + x / 50) {
    const double spacing = 0.5 + x / 50;
    for (double y = 0; y < 40; y += spacing) positions.emplace_back(x, y, 0);
  }
  return positions;
}
double fading_spacing(const glm::dvec3& p) {
  return 0.5 + p.x / 50;
}

/// Some inputs, each with positions and the radii that it states, as one part.
struct Inputs {
  surfel::SurfelCloud cloud;
  PartFrame frame;

  void add(const Positions& positions, const RadiusAt& radius) {
    cloud.sources.push_back({"scan", cloud.size(), positions.size(), {}});
    for (const glm::dvec3& p : positions) {
      cloud.positions.push_back(p);
      cloud.normals.emplace_back(0, 0, 1);
      cloud.radii.push_back(static_cast<float>(radius(p)));
      frame.bounds.include(p);
    }
    frame.sensors.emplace_back();
    frame.inputs.push_back(frame.inputs.size());
  }
};

/// What becomes of the radii of inputs.
struct Decided {
  explicit Decided(const Inputs& inputs, RadiusPolicy policy = RadiusPolicy::kAuto) {
    PartFrame frame = inputs.frame;
    frame.radii = policy;
    PartSigns signs;
    SurfelReport report;
    PartSurfels made = make_surfels(inputs.cloud, frame, signs, report);
    for (const RadiusComparison& comparison : made.radii) decisions.push_back(decide_radii(comparison, policy));
    estimated = made.estimates.radii;
    cloud = std::move(made.cloud);
    apply_radii(decisions, frame.inputs, made.estimates, SurfaceSpacing(made.samples, frame.bounds), cloud);
  }
  Decided(const Positions& positions, const RadiusAt& radius, RadiusPolicy policy = RadiusPolicy::kAuto)
      : Decided(
            [&] {
              Inputs inputs;
              inputs.add(positions, radius);
              return inputs;
            }(),
            policy) {}

  std::vector<RadiusDecision> decisions;
  std::vector<float> estimated;
  surfel::SurfelCloud cloud;
};

float median(std::vector<float> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST(StatedRadiiTest, AFixedMultipleOfTheSpacingIsScaledToTheEstimate) {
  const Positions positions = moved_lattice(40);
  for (const double multiple : {0.5, 0.75, 1.0, 1.5, 2.0}) {
    const Decided decided(positions, [&](const glm::dvec3&) { return multiple; });
    EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kScaled) << multiple;
    EXPECT_NEAR(decided.decisions[0].stating->median, multiple, 0.03 * multiple);
    EXPECT_FALSE(decided.cloud.estimated_radii);
    const float expected = median(decided.estimated);
    for (const float radius : decided.cloud.radii) ASSERT_NEAR(radius, expected, 0.02F * expected) << multiple;
  }
}

TEST(StatedRadiiTest, EstimatesThatAFileStatesStayTheSameBits) {
  const Positions positions = moved_lattice(40);
  Inputs inputs;
  inputs.add(positions, [](const glm::dvec3&) { return 1; });
  inputs.cloud.radii = Decided(inputs, RadiusPolicy::kEstimate).cloud.radii;
  const Decided decided(inputs);
  EXPECT_EQ(decided.decisions[0].factor, 1);
  EXPECT_EQ(decided.cloud.radii, inputs.cloud.radii);
}

TEST(StatedRadiiTest, RadiiThatFollowAnUnevenSamplingKeepTheirVariation) {
  const Positions positions = fading_plane();
  const Decided decided(positions, [](const glm::dvec3& p) { return 0.7 * fading_spacing(p); });
  ASSERT_EQ(decided.decisions[0].outcome, RadiusOutcome::kScaled);
  EXPECT_NEAR(decided.decisions[0].stating->median, 0.7, 0.07);
  const double factor = double{decided.decisions[0].factor};
  for (size_t i = 0; i < positions.size(); ++i) {
    const double expected = factor * 0.7 * fading_spacing(positions[i]);
    ASSERT_NEAR(decided.cloud.radii[i], expected, 1e-6 * expected);
  }
}

TEST(StatedRadiiTest, OneRadiusForAnUnevenSamplingIsEstimated) {
  const Decided decided(fading_plane(), [](const glm::dvec3&) { return 1; });
  EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kEstimated);
  EXPECT_EQ(decided.cloud.radii, decided.estimated);
  EXPECT_TRUE(decided.cloud.estimated_radii);
}

TEST(StatedRadiiTest, RadiiOfUnrelatedSizesAreEstimated) {
  std::mt19937 random(1);
  std::lognormal_distribution<double> sizes(0, 0.9);
  const Decided splats(moved_lattice(60), [&](const glm::dvec3&) { return sizes(random); });
  EXPECT_EQ(splats.decisions[0].outcome, RadiusOutcome::kEstimated);
  EXPECT_THAT(describe(splats.decisions[0]), HasSubstr("do not follow the sampling"));
  EXPECT_EQ(splats.cloud.radii, splats.estimated);
}

TEST(StatedRadiiTest, RadiiInOtherUnitsAreEstimated) {
  for (const double radius : {0.001, 0.3, 4.0, 1000.0}) {
    const Decided decided(moved_lattice(40), [&](const glm::dvec3&) { return radius; });
    EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kEstimated) << radius;
    EXPECT_EQ(decided.cloud.radii, decided.estimated) << radius;
  }
}

TEST(StatedRadiiTest, AnisotropicSamplingsAreScaledByTheAreaOfAPoint) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> move(-0.15, 0.15);
  Positions lines;
  for (int line = 0; line < 30; ++line) {
    for (int i = 0; i < 120; ++i) lines.emplace_back(i + move(random), 4 * (line + move(random)), 0);
  }
  const Decided decided(lines, [](const glm::dvec3&) { return 2; });
  EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kScaled);
  EXPECT_NEAR(decided.cloud.radii[60 + 15 * 120], median(decided.estimated), 0.3 * median(decided.estimated));
}

TEST(StatedRadiiTest, PointsWithoutARadiusGetEstimatesBesideScaledOnes) {
  const Positions positions = moved_lattice(40);
  const auto lacks = [](const glm::dvec3& p) { return std::lround(p.x + p.y) % 2 == 0; };
  const Decided decided(positions, [&](const glm::dvec3& p) { return lacks(p) ? double{kNoRadius} : 0.75; });
  ASSERT_EQ(decided.decisions[0].outcome, RadiusOutcome::kScaled);
  EXPECT_EQ(decided.decisions[0].stated + decided.decisions[0].missing, positions.size());
  EXPECT_EQ(decided.decisions[0].estimated(), decided.decisions[0].missing);
  for (size_t i = 0; i < positions.size(); ++i) {
    const double expected = lacks(positions[i]) ? double{decided.estimated[i]} : 1.0;
    ASSERT_NEAR(decided.cloud.radii[i], expected, lacks(positions[i]) ? 0 : 0.15) << i;
  }
}

TEST(StatedRadiiTest, EachInputHasAFactorOfItsOwnEvenOnTheSameSurface) {
  const Positions positions = moved_lattice(60);
  Positions halves[2];
  for (size_t i = 0; i < positions.size(); ++i) halves[(i + i / 60) % 2].push_back(positions[i]);
  Inputs inputs;
  inputs.add(halves[0], [](const glm::dvec3&) { return 0.5; });
  inputs.add(halves[1], [](const glm::dvec3&) { return 2; });
  inputs.add({{10, 10, 5}}, [](const glm::dvec3&) { return double{kNoRadius}; });
  const Decided decided(inputs);
  EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kScaled);
  EXPECT_EQ(decided.decisions[1].outcome, RadiusOutcome::kScaled);
  EXPECT_NEAR(decided.decisions[0].factor, 4 * decided.decisions[1].factor, 0.1);
  EXPECT_EQ(decided.decisions[2].missing, 1U);
}

TEST(StatedRadiiTest, InputsWithTheSamePositionsAreComparedEach) {
  const Positions positions = moved_lattice(40);
  Inputs inputs;
  for (const double radius : {0.5, 50.0, 2.0}) inputs.add(positions, [radius](const glm::dvec3&) { return radius; });
  const Decided decided(inputs);
  EXPECT_NEAR(decided.decisions[0].factor, 4 * decided.decisions[2].factor, 0.1);
  EXPECT_EQ(decided.decisions[1].outcome, RadiusOutcome::kEstimated);
}

TEST(StatedRadiiTest, KeptRadiiStayTheSameBits) {
  const Positions positions = moved_lattice(20);
  const auto radius = [](const glm::dvec3& p) { return p.x < 10 ? 0.01 : 100; };
  const Decided decided(positions, radius, RadiusPolicy::kKeep);
  EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kKept);
  for (size_t i = 0; i < positions.size(); ++i) {
    ASSERT_EQ(decided.cloud.radii[i], static_cast<float>(radius(positions[i])));
  }
}

TEST(StatedRadiiTest, ZeroIsNoRadius) {
  const Decided decided(moved_lattice(20), [](const glm::dvec3&) { return 0; });
  EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kEstimated);
  EXPECT_THAT(describe(decided.decisions[0]), HasSubstr("no radius is finite and positive"));
  EXPECT_EQ(decided.cloud.radii, decided.estimated);
}

TEST(StatedRadiiTest, AFewRadiiSayNothingAndStay) {
  const Decided decided(moved_lattice(5), [](const glm::dvec3&) { return 70; });
  EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kKept);
  EXPECT_THAT(decided.cloud.radii, ::testing::Each(70.0F));
}

TEST(StatedRadiiTest, RadiiAtTheEndsOfFloatsAreCompared) {
  for (const float radius : {std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::max()}) {
    const Decided decided(moved_lattice(20), [&](const glm::dvec3&) { return double{radius}; });
    EXPECT_EQ(decided.decisions[0].outcome, RadiusOutcome::kEstimated) << radius;
  }
}

TEST(RadiusComparisonTest, PartsAddUpInAnyOrder) {
  RadiusComparison whole;
  RadiusComparison odd;
  RadiusComparison even;
  for (int i = 1; i <= 1000; ++i) {
    const double ratio = std::exp2(i % 37 - 18) * i;
    whole.add_ratio(ratio);
    (i % 2 == 1 ? odd : even).add_ratio(ratio);
  }
  odd.add_stated(500, 0);
  odd.add_missing(1, 0);
  even.add_stated(500, 0);
  even.add_missing(2, 0);
  RadiusComparison one = odd;
  one.add(even);
  RadiusComparison other = even;
  other.add(odd);
  EXPECT_EQ(one.stated(), 1000U);
  EXPECT_EQ(one.missing(), 3U);
  for (const double share : {0.0, 0.05, 0.5, 0.95, 1.0}) {
    EXPECT_EQ(one.quantile(share), whole.quantile(share)) << share;
    EXPECT_EQ(other.quantile(share), whole.quantile(share)) << share;
  }
}

TEST(RadiusComparisonTest, ItsNumbersStateAllOfIt) {
  RadiusComparison comparison;
  EXPECT_EQ(RadiusComparison::of_numbers(comparison.numbers())->numbers(), comparison.numbers());
  comparison.add_stated(7, 2);
  comparison.add_missing(5, 1);
  for (const double ratio : {0.5, 1.0, 1.1, 4.0}) comparison.add_ratio(ratio);
  const std::optional<RadiusComparison> read = RadiusComparison::of_numbers(comparison.numbers());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->stated(), 7U);
  EXPECT_EQ(read->missing(), 5U);
  EXPECT_EQ(read->stated_scatter(), 2U);
  EXPECT_EQ(read->missing_scatter(), 1U);
  EXPECT_EQ(read->ratios(), 4U);
  EXPECT_EQ(read->quantile(0.5), comparison.quantile(0.5));
  EXPECT_FALSE(RadiusComparison::of_numbers({}));
  EXPECT_FALSE(RadiusComparison::of_numbers(std::vector<uint64_t>(5)));
}

TEST(RadiusComparisonTest, QuantilesAreWithinHalfAStep) {
  RadiusComparison comparison;
  for (int i = 0; i <= 100; ++i) comparison.add_ratio(0.5 + 0.01 * i);
  EXPECT_NEAR(comparison.quantile(0), 0.5, 0.5 * 0.006);
  EXPECT_NEAR(comparison.quantile(0.5), 1, 0.006);
  EXPECT_NEAR(comparison.quantile(0.95), 1.45, 1.45 * 0.006);
}

}  // namespace
}  // namespace surfcast::estimation
