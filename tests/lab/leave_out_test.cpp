// Points left out: the choice of points, the verdicts, the witness and the depths of models, in closed form.

#include "lab/leave_out.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "lab/colored_points.h"
#include "lab/kernel_defines.h"
#include "lab/leave_out_cameras.h"
#include "lab/leave_out_report.h"
#include "lab/model_depth.h"
#include "lab/paint_rows.h"
#include "lab/scan_points.h"
#include "lab/witness.h"

namespace surfcast::lab {
namespace {

constexpr double kSpacing = 0.1;

/// A square lattice on the plane z = 0, side x side points around the origin.
std::vector<glm::dvec3> lattice(int side) {
  std::vector<glm::dvec3> points;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      points.push_back(kSpacing * glm::dvec3(x - 0.5 * side, y - 0.5 * side, 0));
    }
  }
  return points;
}

/// Looks down from a height over the origin; 100 pixels to a unit of tangent.
geometry::CameraFrame looking_down(double height) {
  const double angle = 2 * std::atan(0.5) * 180 / std::numbers::pi;
  return *geometry::make_camera_frame({{0, 0, height}, {0, 0, height - 1}, {0, 1, 0}, angle}, 100, 100);
}

DepthPicture flat(float depth) {
  DepthPicture picture(9, 9);
  std::ranges::fill(picture.depths, depth);
  return picture;
}

constexpr glm::dvec2 kMiddle{4.5, 4.5};

TEST(LeftOutTest, IsOneInFive) {
  const std::vector<glm::dvec3> points = lattice(300);
  const auto out = static_cast<double>(std::ranges::count_if(points, left_out));
  const auto all = static_cast<double>(points.size());
  EXPECT_NEAR(out / all, 0.2, 4 * std::sqrt(0.2 * 0.8 / all));  // four standard deviations of a fair choice
}

TEST(LeftOutTest, DependsOnThePlaceAlone) {
  EXPECT_EQ(left_out({0.0, 1, 2}), left_out({-0.0, 1, 2}));
  EXPECT_EQ(left_out({1e6, 5e6, 12.5}), left_out({1e6, 5e6, 12.5}));
}

TEST(JudgeTest, APointOnItsSurfaceIsSeen) {
  EXPECT_EQ(judge(flat(10), kMiddle, 10, 0.5), Verdict::kSeen);
  EXPECT_EQ(judge(flat(10), kMiddle, 10.5, 0.5), Verdict::kSeen);
  EXPECT_EQ(judge(flat(10), kMiddle, 9.5, 0.5), Verdict::kSeen);
}

TEST(JudgeTest, APointBehindASurfaceIsHidden) {
  EXPECT_EQ(judge(flat(10), kMiddle, 10.6, 0.5), Verdict::kHidden);
}

TEST(JudgeTest, APointInFrontOfASurfaceOrOfNothingIsMissing) {
  EXPECT_EQ(judge(flat(10), kMiddle, 9.4, 0.5), Verdict::kMissing);
  EXPECT_EQ(judge(DepthPicture(9, 9), kMiddle, 9.4, 0.5), Verdict::kMissing);
}

TEST(JudgeTest, SixOfNinePixelsAreNotEnough) {
  DepthPicture picture = flat(10);
  for (const int x : {3, 4, 5}) {
    for (const int y : {3, 4}) picture.depths[picture.index(x, y)] = 5;
  }
  EXPECT_EQ(judge(picture, kMiddle, 10, 0.5), Verdict::kSeen);
  picture.depths[picture.index(3, 5)] = 5;
  EXPECT_EQ(judge(picture, kMiddle, 10, 0.5), Verdict::kHidden);
}

TEST(JudgeTest, ASteepSlopeNeitherHidesNorMissesItsOwnPoints) {
  DepthPicture slope(9, 9);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) slope.depths[slope.index(x, y)] = static_cast<float>(10 + 5 * (y - 4));
  }
  EXPECT_EQ(judge(slope, kMiddle, 10, 0.5), Verdict::kSeen);
}

TEST(JudgeTest, PointsAtTheBorderOfThePictureAreLeftAlone) {
  EXPECT_FALSE(judge(flat(10), {0.9, 4.5}, 10, 0.5));
  EXPECT_FALSE(judge(flat(10), {4.5, 8.1}, 10, 0.5));
  EXPECT_FALSE(judge(flat(10), {std::nan(""), 4.5}, 10, 0.5));
  EXPECT_TRUE(judge(flat(10), {1, 7.9}, 10, 0.5));
}

TEST(DepthToleranceTest, IsTwoSpacingsAndAPixel) {
  EXPECT_DOUBLE_EQ(depth_tolerance(0.25, 30, 600), 0.55);
}

TEST(LeaveOutCountsTest, SharesAreOfTheOpenPoints) {
  LeaveOutCounts counts;
  for (int i = 0; i < 6; ++i) counts.count(Verdict::kSeen, true);
  counts.count(Verdict::kHidden, true);
  counts.count(Verdict::kHidden, false);
  counts.count(Verdict::kMissing, false);
  counts.count(Verdict::kSeen, false);
  EXPECT_DOUBLE_EQ(counts.percent(Verdict::kHidden), 20);
  EXPECT_DOUBLE_EQ(counts.percent(Verdict::kMissing), 10);
  EXPECT_DOUBLE_EQ(counts.off_surface_percent(), 30);
  EXPECT_NEAR(counts.surface_hidden_percent(), 100.0 / 7, 1e-12);
}

TEST(ColorErrorsTest, AreRootMeanSquares) {
  ColorErrors errors;
  EXPECT_FALSE(errors.rms());
  errors.add({10, 10, 10}, {10, 13, 10});
  errors.add({0, 0, 255}, {0, 0, 251});
  EXPECT_DOUBLE_EQ(*errors.rms(), std::sqrt((9.0 + 16.0) / 6));
}

TEST(WitnessTest, APlaneIsASurface) {
  const std::vector<glm::dvec3> points = lattice(40);
  const std::vector<WitnessPoint> witness = make_witness(points);
  EXPECT_TRUE(std::ranges::all_of(witness, &WitnessPoint::surface));
  const WitnessPoint& inner = witness[20 * 40 + 20];
  const double mean = kSpacing * (4 + 2 * std::numbers::sqrt2) / 6;  // four neighbours and two on the diagonals
  EXPECT_NEAR(inner.spacing, mean, 1e-9);
  EXPECT_NEAR(inner.radius, 1.2 * mean, 1e-9);
  EXPECT_NEAR(std::abs(inner.normal.z), 1, 1e-9);
}

TEST(WitnessTest, AStrayIsASplatOfAQuarterOfItsDistance) {
  std::vector<glm::dvec3> points = lattice(40);
  points.emplace_back(0, 0, 2);
  const std::vector<WitnessPoint> witness = make_witness(points);
  EXPECT_FALSE(witness.back().surface);
  EXPECT_NEAR(witness.back().radius, 0.25 * 2, 1e-9);
}

TEST(WitnessTest, AVolumeIsNoSurface) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 cell(i % 10, i / 10 % 10, i / 100);
    points.push_back(kSpacing * (cell + 0.3 * glm::dvec3(std::sin(i * 1.3), std::sin(i * 2.7), std::sin(i * 4.1))));
  }
  const std::vector<WitnessPoint> witness = make_witness(points);
  const auto surface = std::ranges::count_if(witness, &WitnessPoint::surface);
  EXPECT_LT(surface, 20);
}

TEST(WitnessTest, APlaneHidesWhatIsBehindIt) {
  std::vector<glm::dvec3> points = lattice(60);
  points.emplace_back(0.01, 0.01, -1);
  const std::vector<WitnessPoint> witness = make_witness(points);
  const geometry::CameraFrame frame = looking_down(4);
  const DepthPicture depths = witness_depths(points, witness, frame);
  EXPECT_NEAR(depths.depths[depths.index(50, 50)], 4, 1e-6);
  EXPECT_EQ(judge(depths, frame.project(frame.to_camera(points.back())), 5, 0.5), Verdict::kHidden);
  EXPECT_EQ(judge(depths, frame.project(frame.to_camera(points[60 * 30 + 30])), 4, 0.5), Verdict::kSeen);
}

TEST(WitnessTest, ADiscBehindTheEyeHidesNothing) {
  const std::vector<glm::dvec3> points = lattice(20);
  const geometry::CameraFrame frame = *geometry::make_camera_frame({{0, 0, 3}, {0, 0, 6}, {0, 1, 0}, 40}, 90, 90);
  const DepthPicture depths = witness_depths(points, make_witness(points), frame);
  EXPECT_TRUE(std::ranges::all_of(depths.depths, [](float d) { return std::isinf(d); }));
}

TEST(PixelsWithinTest, HoldTheWholePictureOfASphere) {
  const geometry::CameraFrame frame = looking_down(0);  // looks along -z from the origin
  const PixelBox box = pixels_within(frame, {0, 0, 10}, 1, 0);
  const double reach = 100 / std::sqrt(99.0);  // the tangent of the cone around the sphere, 100 pixels to a unit
  EXPECT_LE(box.first_x, 50 - reach);
  EXPECT_GE(box.last_x, 50 + reach);
  EXPECT_LT(box.last_x - box.first_x, 26);
}

TEST(PixelsWithinTest, ASphereAtTheEyeIsAnywhereInThePicture) {
  const PixelBox box = pixels_within(looking_down(0), {0.5, 0, 0.2}, 1, 0);
  EXPECT_EQ(box.last_x - box.first_x, 100);
}

TEST(PixelsWithinTest, ASphereBesideOrBehindTheEyeIsNowhere) {
  const geometry::CameraFrame frame = looking_down(0);
  EXPECT_TRUE(pixels_within(frame, {5, 0, 0.2}, 1, 0.5).empty());
  EXPECT_TRUE(pixels_within(frame, {0, -5, 0.2}, 1, 0.5).empty());
  EXPECT_TRUE(pixels_within(frame, {0, 0, -2}, 1, 0.5).empty());
}

/// A model of one lattice.
DrawnSurfels surfels_on(std::vector<glm::dvec3> points, double radius) {
  const size_t count = points.size();
  return {std::move(points), std::vector<glm::dvec3>(count, {0, 0, 1}), std::vector<double>(count, radius), {}, false};
}

TEST(ModelDepthTest, IsThatOfThePlane) {
  const DepthPicture depths = model_depths(surfels_on(lattice(80), kSpacing), looking_down(4));
  for (int i = 10; i < 90; ++i) EXPECT_NEAR(depths.depths[depths.index(i, i)], 4, 1e-6);
}

TEST(ModelDepthTest, ATiltedPlaneHasTheDepthOfThePixelsRay) {
  const DrawnSurfels surfels = surfels_on(lattice(80), kSpacing);
  const geometry::CameraFrame frame = *geometry::make_camera_frame({{0, -3, 3}, {0, 0, 0}, {0, 0, 1}, 40}, 100, 100);
  const DepthPicture depths = model_depths(surfels, frame);
  for (int y = 30; y < 70; ++y) {
    const glm::dvec3 ray = frame.ray({50.5, y + 0.5});
    const double expected = -frame.eye.z / (frame.right * ray.x + frame.up * ray.y + frame.forward).z;
    EXPECT_NEAR(depths.depths[depths.index(50, y)], expected, 1e-6 * expected);
  }
}

TEST(ModelDepthTest, TheNearerOfTwoSheetsIsShown) {
  std::vector<glm::dvec3> points = lattice(80);
  for (const glm::dvec3& p : lattice(80)) points.push_back(p - glm::dvec3(0, 0, 1));
  const DepthPicture depths = model_depths(surfels_on(points, kSpacing), looking_down(4));
  EXPECT_NEAR(depths.depths[depths.index(50, 50)], 4, 1e-6);
}

TEST(ModelDepthTest, BackFacesOfAnOrientedModelAreBackground) {
  DrawnSurfels surfels = surfels_on(lattice(80), kSpacing);
  surfels.oriented = true;
  for (glm::dvec3& n : surfels.normals) n = -n;
  const DepthPicture depths = model_depths(surfels, looking_down(4));
  EXPECT_TRUE(std::ranges::all_of(depths.depths, [](float d) { return std::isinf(d); }));
}

TEST(ModelDepthTest, ADiscSeenEdgeOnIsNotNearerThanItsRim) {
  DrawnSurfels surfels = surfels_on({{0, 0, 0}}, 0.1);
  surfels.normals = {glm::normalize(glm::dvec3(1, 0, 0.02))};
  const DepthPicture depths = model_depths(surfels, looking_down(4));
  EXPECT_TRUE(std::ranges::any_of(depths.depths, [](float d) { return std::isfinite(d); }));
  EXPECT_GE(std::ranges::min(depths.depths), 4 - 1.1 * 0.1);
}

TEST(WitnessTest, IsAsWideInAPictureAsTheDiscsOfAModel) {
  const std::vector<glm::dvec3> points{{0, 0, 0}, {1, 0, 0}, {0.003, 0.8, 0}};
  const std::vector<WitnessPoint> witness(3, {1, true, 0.01, {0, 0, 1}});
  const DepthPicture drawn = witness_depths(points, witness, looking_down(4));
  const DepthPicture model = model_depths(surfels_on(points, 0.01), looking_down(4));
  for (size_t i = 0; i < model.depths.size(); ++i) EXPECT_EQ(drawn.depths[i], model.depths[i]);
}

TEST(LeaveOutCamerasTest, AStrayOverAHoleDoesNotLiftTheEyesOnTheGround) {
  std::vector<glm::dvec3> points = lattice(60);
  std::erase_if(points, [](const glm::dvec3& p) { return std::abs(p.x) < 0.3 && std::abs(p.y) < 0.3; });
  std::vector<double> spacings(points.size(), kSpacing);
  points.emplace_back(0, 0, 5);
  spacings.push_back(5);
  for (const NamedCamera& c : leave_out_cameras(points, spacings, Place::kGround, true)) {
    if (!c.name.starts_with("ground")) continue;
    EXPECT_LT(c.camera.focal_point.z, 7) << c.name;
  }
}

TEST(LeaveOutCamerasTest, EyesOnTheGroundAreAtTheHeightOfAPerson) {
  const std::vector<glm::dvec3> points = lattice(60);
  const std::vector<double> spacings(points.size(), kSpacing);
  for (const NamedCamera& c : leave_out_cameras(points, spacings, Place::kGround, true)) {
    if (!c.name.starts_with("ground")) continue;
    EXPECT_DOUBLE_EQ(c.camera.position.z, 1.7) << c.name;
  }
}

TEST(LeaveOutCamerasTest, EveryPlaceHasFiveToElevenThatFaceTheScan) {
  const std::vector<glm::dvec3> points = lattice(60);
  const std::vector<double> spacings(points.size(), kSpacing);
  for (const char* name : {"ground", "sweep", "object", "room"}) {
    const std::vector<NamedCamera> cameras = leave_out_cameras(points, spacings, *place_named(name), true);
    EXPECT_GE(cameras.size(), 5) << name;
    EXPECT_LE(cameras.size(), 11) << name;
    for (const NamedCamera& c : cameras) EXPECT_TRUE(geometry::make_camera_frame(c.camera, 640, 480)) << c.name;
  }
  EXPECT_FALSE(place_named("anywhere"));
}

TEST(PlacedScanTest, ThePlaceStandsBeforeTheFirstColon) {
  EXPECT_EQ(placed_scan("room:a/b.laz").place, Place::kRoom);
  EXPECT_EQ(placed_scan("room:a/b.laz").path, "a/b.laz");
  EXPECT_FALSE(placed_scan("a/b.laz").place);
  EXPECT_EQ(placed_scan("c:a.laz").path, "c:a.laz");
}

TEST(ScanPointsTest, PointsAtOnePlaceCountOnce) {
  const std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) / ("points_at_one_place_" + std::to_string(::getpid()) + ".ply");
  const LabPoints points{{{1, 2, 3}, {4, 5, 6}, {1, 2, 3}}, {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, {7, 8, 9}, {}, true};
  ASSERT_TRUE(write_ply(points, path));
  const Result<LabPoints> read = read_points(path);
  std::filesystem::remove(path);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->positions, (std::vector<glm::dvec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(read->colors, (std::vector<glm::u8vec3>{{1, 1, 1}, {2, 2, 2}}));
  EXPECT_EQ(read->intensities, (std::vector<float>{7, 8}));
}

TEST(ColoredPointsTest, ElevationAndLightColorAScanWithoutIntensity) {
  LabPoints points{lattice(20), {}, {}, {}, true};
  for (glm::dvec3 p : lattice(20)) points.positions.push_back(p + glm::dvec3(10, 0, 0.1 * p.y + 3));
  const std::vector<glm::u8vec3> colors = colors_for(points);
  ASSERT_EQ(colors.size(), points.size());
  EXPECT_NE(colors.front(), colors.back());
}

TEST(ColoredPointsTest, IntensityIsGrey) {
  LabPoints points{lattice(20), {}, std::vector<float>(400, 1), {}, true};
  for (size_t i = 0; i < 200; ++i) points.intensities[i] = 5;
  for (const glm::u8vec3& c : colors_for(points)) EXPECT_TRUE(c.r == c.g && c.g == c.b);
}

TEST(IntensityLevelsTest, RunFromTheSecondToTheLastButOnePercentile) {
  std::vector<float> intensities;
  for (int i = 0; i <= 100; ++i) intensities.push_back(static_cast<float>(i));
  const std::vector<glm::u8vec3> levels = intensity_levels(intensities);
  EXPECT_EQ(levels[1], glm::u8vec3(0));
  EXPECT_EQ(levels[50], glm::u8vec3(128));
  EXPECT_EQ(levels[99], glm::u8vec3(255));
  EXPECT_TRUE(intensity_levels({7, 7, 7}).empty());
}

TEST(LeaveOutReportTest, SurvivesItsJson) {
  LeaveOutReport report{{0.35, 0.5}, {{"lion", 342, 18, 8, 0.5, 4.1, 3.5, {18.25, 18.5}, {17, 16}}}};
  LeaveOutResult result{"lion", 342, 68, 3.5};
  result.cameras.push_back({{"above", {}}, {}, {}});
  const std::optional<LeaveOutReport> read = report_of(json_of(report, {result}));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->sigmas, report.sigmas);
  EXPECT_EQ(read->scans[0].scan, "lion");
  EXPECT_EQ(read->scans[0].near_colors, report.scans[0].near_colors);
  EXPECT_FALSE(report_of("{}"));
}

TEST(LeaveOutReportTest, EarlierFiguresStandFirst) {
  const LeaveOutReport now{{0.35}, {{"lion", 342, 18, 2.8, 0.2, 1, 3, {18.2}, {}}}};
  const LeaveOutReport before{{0.35}, {{"lion", 342, 18, 8, 0, 4.1, 87, {18.5}, {}}}};
  const std::string text = markdown_of(now, before);
  EXPECT_NE(text.find("| lion | 342 | 18.0 | 8.00 + 0.00 | 4.10 | 87.0 | 18.50 | 2.80 + 0.20 | 1.00 | 3.0 | 18.20 |"),
            std::string::npos)
      << text;
}

TEST(KernelDefinesTest, AnotherSigmaScalesTheCoverageWithItsArea) {
  EXPECT_NE(kernel_defines(0.7).find("SURFCAST_KERNEL_SIGMA 0.7"), std::string::npos);
  EXPECT_NE(kernel_defines(0.7).find("SURFCAST_COVERAGE_MINIFIED 3.6"), std::string::npos);
}

}  // namespace
}  // namespace surfcast::lab
