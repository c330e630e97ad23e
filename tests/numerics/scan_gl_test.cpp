// Scans with invalid or degenerate points, from the file to the picture.

#include <array>
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>

#include "builder/build_model.h"
#include "numerics/numerics_fixture.h"

namespace surfcast::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Rows of a text file with positions, normals, radii and colours.
struct TextScan {
  std::string text = "x y z nx ny nz radius red green blue\n";

  void add(const std::string& row) { text += row + '\n'; }
  /// Adds a square of 20 x 20 points with a spacing of 1, facing z. `row_of` gives the row of each point.
  template <typename RowOf>
  void add_square(const RowOf& row_of) {
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 20; ++x) add(row_of(20 * y + x, std::to_string(x) + ' ' + std::to_string(y) + " 0"));
    }
  }
};

class ScanGLTest : public NumericsGLTest {
 protected:
  Result<builder::BuildReport> build(const TextScan& scan) {
    const std::filesystem::path path = folder_ / "scan.txt";
    std::ofstream(path) << scan.text;
    return builder::build_model(std::span(&path, 1), folder_ / "scan.surf", {}, [](const builder::BuildStep&) {});
  }

  /// Builds a model of the scan, draws it and compares the picture with the reference. Returns the number of surfels.
  uint64_t surfels_of(const std::string& what, const TextScan& scan, const Difference& bound = kSplats) {
    const Result<builder::BuildReport> built = build(scan);
    EXPECT_TRUE(built) << (built ? "" : built.error().message);
    Result<model::ModelFile> opened = model::ModelFile::open(folder_ / "scan.surf");
    EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
    if (!built || !opened) return 0;
    if (model_) renderer_->release_model(*model_);
    model_ = std::make_shared<const model::ModelFile>(std::move(*opened));
    picture::PictureRequest request;
    request.width = 160;
    request.height = 120;
    request.camera = draw(model_, request).camera;
    expect_within(difference(what, model_, request), bound);
    return built->surfels;
  }
};

const std::string kNormal = " 0 0 1";
const std::string kRest = " 1.1 200 90 20";

TEST_F(ScanGLTest, PositionsThatAreNoNumbersAreLeftOut) {
  TextScan scan;
  scan.add_square([](int i, const std::string& position) {
    const char* odd[] = {"nan 1 0", "inf 1 0", "1 -inf 0", "1 1 nan"};
    return (i % 9 == 0 ? odd[i % 4] : position) + kNormal + kRest;
  });
  EXPECT_EQ(surfels_of("positions that are no numbers", scan), 400U - 45U);
}

TEST_F(ScanGLTest, NormalsOfZeroOrNoNumberAreLeftOut) {
  TextScan scan;
  scan.add_square([](int i, const std::string& position) {
    const char* odd[] = {" 0 0 0", " nan 0 1", " 0 inf 0", " 0 0 1e-30"};
    return position + (i % 9 == 0 ? odd[i % 4] : kNormal) + kRest;
  });
  EXPECT_GE(surfels_of("normals of zero", scan), 400U - 45U);
}

TEST_F(ScanGLTest, RadiiThatAreNoneAreEstimated) {
  TextScan scan;
  scan.add_square([](int i, const std::string& position) {
    const char* odd[] = {" 0", " -1", " nan", " inf"};
    return position + kNormal + (i % 9 == 0 ? odd[i % 4] : " 1.1") + " 200 90 20";
  });
  EXPECT_EQ(surfels_of("radii of zero", scan), 400U);
}

TEST_F(ScanGLTest, CoincidentPointsAreDrawnAtTheirPlace) {
  TextScan scan;
  for (int i = 0; i < 50; ++i) scan.add("3 4 5" + kNormal + " 1.1 " + std::to_string(5 * i) + " 90 20");
  EXPECT_EQ(surfels_of("coincident points", scan), 50U);
}

TEST_F(ScanGLTest, CoincidentPointsWithoutRadiiAreDrawnAtTheirPlace) {
  TextScan scan;
  scan.text = "x y z intensity\n";
  for (int i = 0; i < 50; ++i) scan.add("3 4 5 " + std::to_string(i));
  EXPECT_EQ(surfels_of("coincident points without radii", scan), 50U);
}

TEST_F(ScanGLTest, PointsOneRoundingApartAreDrawn) {
  TextScan scan;
  scan.text = "x y z\n";
  double x = 5e6;
  for (int i = 0; i < 50; ++i) {
    std::array<char, 64> row{};
    std::snprintf(row.data(), row.size(), "%.17g 5000000 %d", x, i % 2);
    scan.add(row.data());
    x = std::nextafter(x, 1e7);
  }
  EXPECT_EQ(surfels_of("points one rounding apart", scan), 50U);
}

TEST_F(ScanGLTest, OneTwoAndThreePointsAreScans) {
  TextScan scan;
  scan.text = "x y z\n";
  const char* rows[] = {"1 2 3", "1 2 4", "1 2 7"};
  for (uint64_t i = 0; i < 3; ++i) {
    scan.add(rows[i]);
    EXPECT_EQ(surfels_of(std::to_string(i + 1) + " points", scan), i + 1);
  }
}

TEST_F(ScanGLTest, CoordinatesOfAnyMagnitudeAreDrawn) {
  for (const char* unit : {"e-9", "e-3", "e9", "e18", "e30"}) {
    TextScan scan;
    scan.text = "x y z\n";
    for (int i = 0; i < 400; ++i) {
      scan.add(std::to_string(i % 20) + unit + ' ' + std::to_string(i / 20) + unit + " 0");
    }
    EXPECT_EQ(surfels_of(std::string("coordinates of 1") + unit, scan), 400U);
  }
}

TEST_F(ScanGLTest, AScanOfNothingUsableIsRefusedInOneLine) {
  TextScan nothing;
  for (int i = 0; i < 5; ++i) nothing.add("nan inf -inf" + kNormal + kRest);
  const Result<builder::BuildReport> built = build(nothing);
  ASSERT_FALSE(built);
  EXPECT_THAT(built.error().message, Not(HasSubstr("\n")));
}

}  // namespace
}  // namespace surfcast::testing
