// What the laboratory makes of its measurements.

#include "lab/report.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include <gtest/gtest.h>

#include "lab/plots.h"
#include "lab/scenes.h"
#include "lab/volume_report.h"
#include "support/path_of.h"

namespace surfcast::lab {
namespace {

Measurement measured(const std::string& method, double milliseconds, double psnr) {
  Measurement m;
  m.method = method;
  m.milliseconds = m.processor_milliseconds = milliseconds;
  m.errors = {psnr, 0.9, psnr - 5};
  return m;
}

LabResults example() {
  const std::vector<Measurement> measurements{measured("points", 10, 15),         measured("no prefilter", 20, 30),
                                              measured("papers' kernel", 50, 28), measured("per surfel", 26, 33),
                                              measured("per pixel", 25, 34),      measured("at rest", 30, 33.5)};
  return {"a device",
          7,
          {{"points", "", true},
           {"no prefilter", "", true},
           {"papers' kernel", ""},
           {"per surfel", ""},
           {"per pixel", ""},
           {"at rest", ""}},
          {{"checker_oblique", "a plane", 65536, measurements}}};
}

TEST(FrontierTest, KeepsWhatNothingBeatsInBoth) {
  const std::vector<Measurement> m{measured("a", 10, 20), measured("slower and worse", 12, 19), measured("b", 15, 30),
                                   measured("slow, best", 40, 31), measured("as slow, worse", 40, 30.5)};
  EXPECT_EQ(frontier(m), (std::vector<size_t>{0, 2, 3}));
}

TEST(FrontierTest, OfNothingIsNothing) {
  EXPECT_TRUE(frontier({}).empty());
}

TEST(SectionTest, IsReplacedBetweenItsMarkersAndTwiceIsOnce) {
  const auto once = with_section("before\n<a>\nold\n<b>\nafter\n", "<a>", "<b>", "new\n");
  ASSERT_TRUE(once);
  EXPECT_EQ(*once, "before\n<a>\n\nnew\n<b>\nafter\n");
  EXPECT_EQ(*with_section(*once, "<a>", "<b>", "new\n"), *once);
}

TEST(SectionTest, MarkersThatAreMissingDoubledOrSwappedAreRefused) {
  for (const char* text : {"", "<a>", "<b>", "<b><a>", "<a><b><a>"}) {
    EXPECT_FALSE(with_section(text, "<a>", "<b>", "new")) << text;
  }
}

TEST(SectionTest, ThePageOfTheDocumentationHasItsMarkers) {
  std::ostringstream page;
  page << std::ifstream(std::filesystem::path(path_of("docs")) / kResultsPage).rdbuf();
  EXPECT_TRUE(with_section(page.str(), kResultsBegin, kResultsEnd, markdown_of(example())));
}

TEST(SectionTest, ThePageHasTheMarkersOfVolumesAndTheirResultsAreLinesOf120Columns) {
  const VolumeResults results{example(), example(), {{"chest_ct-bone", "256 x 256 x 133", 1024, 3000, 2900, 55}}};
  std::ostringstream page;
  page << std::ifstream(std::filesystem::path(path_of("docs")) / kResultsPage).rdbuf();
  EXPECT_TRUE(with_section(page.str(), kVolumesBegin, kVolumesEnd, markdown_of(results)));
  std::istringstream text(markdown_of(results));
  for (std::string line; std::getline(text, line);) {
    EXPECT_TRUE(line.starts_with("|") || line.size() <= 120) << line;
  }
  EXPECT_NE(markdown_of(results).find("| chest_ct-bone | 256 x 256 x 133 | 1024 x 1024 | 2900 ms | 55.0 dB |"),
            std::string::npos);
}

TEST(ReportTest, LinesOfProseHave120ColumnsAtMost) {
  std::istringstream text(markdown_of(example()));
  for (std::string line; std::getline(text, line);) {
    EXPECT_TRUE(line.starts_with("|") || line.size() <= 120) << line;
  }
}

TEST(ReportTest, SaysWhatIsGainedOverPlainMethodsAndThePapers) {
  const std::string text = markdown_of(example());
  EXPECT_NE(
      text.find(
          "| checker_oblique | no prefilter, 30.0 dB | 4.0 dB | 3.5 dB | 28.0 dB | 6.0 dB | 5.5 dB | 0.50 | 0.60 |"),
      std::string::npos)
      << text;
}

TEST(ReportTest, PutsRensRatiosBesideOurs) {
  const std::string text = markdown_of(example());
  EXPECT_NE(text.find("| EWA, per-pixel normalisation | 1.3, 1.0 | 44.1, 59.6 | 25.0 | 1.25 | 34.0 dB |"),
            std::string::npos)
      << text;
}

TEST(ReportTest, TheBestPictureOfASceneIsBold) {
  EXPECT_NE(markdown_of(example()).find("25.0 ms, **34.0 dB**"), std::string::npos);
}

TEST(ReportTest, JsonHoldsEveryMeasurement) {
  const auto json = nlohmann::json::parse(json_of(example()));
  ASSERT_EQ(json["scenes"][0]["measurements"].size(), 6);
  EXPECT_EQ(json["scenes"][0]["measurements"][4]["psnr"], 34);
}

TEST(ReportTest, EqualPicturesAreNullInJson) {
  LabResults results = example();
  results.scenes[0].measurements[0].errors.psnr = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(nlohmann::json::parse(json_of(results))["scenes"][0]["measurements"][0]["psnr"].is_null());
}

TEST(ReportTest, ScansJudgedByPointsLeftOutHaveATableOfTheirOwn) {
  EXPECT_EQ(markdown_of(example()).find("Points left out"), std::string::npos);
  LabResults results = example();
  results.scenes[0].left_out = LeaveOutFigures{"lion", 342, 18, 4.81, 0.09, 3, 7, {20, 18.5, 19, 17.25, 17, 17.5}, {}};
  const std::string text = markdown_of(results);
  EXPECT_NE(text.find("| checker_oblique | 4.8 + 0.1 | 20.00 | 18.50 | 19.00 | 17.25 | **17.00** | 17.50 |"),
            std::string::npos)
      << text;
  EXPECT_EQ(nlohmann::json::parse(json_of(results))["scenes"][0]["left_out"]["colors"][4], 17);
}

TEST(PlotTest, HasAMarkForEveryMeasurement) {
  const std::string svg = svg_of(example());
  size_t marks = 0;
  for (size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++marks;
  EXPECT_EQ(marks, 2 * 6) << "legend and plot";
}

TEST(SlowPathTest, MovesTheFocalPointByAFractionOfAPixel) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40};
  const auto path = slow_path(request, 256, 3);
  ASSERT_EQ(path.size(), 3);
  const geometry::CameraFrame frame = *geometry::make_camera_frame(*path[2].camera, 256, 256);
  const glm::dvec2 origin = frame.project(frame.to_camera({0, 0, 0}));
  EXPECT_NEAR(origin.x, 128 - 2 * 0.37, 1e-9);
  EXPECT_NEAR(origin.y, 128 + 2 * 0.21, 1e-9);
}

}  // namespace
}  // namespace surfcast::lab
