#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "model/model_file.h"
#include "support/path_of.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

struct Answer {
  int exit_code = -1;
  std::string out;
  std::string err;
};

std::string content(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Runs the program in a folder of its own, with a small scan in it.
class SurfcastdTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("surfcastd_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::ofstream scan(folder_ / "scan.ply");
    scan << "ply\nformat ascii 1.0\nelement vertex 103\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    for (int i = 0; i < 100; ++i) scan << i % 10 << ' ' << i / 10 << " 0 255 " << i << " 0\n";
    scan << "3 3 0 255 33 0\n";  // a duplicate
    scan << "nan 0 0 1 2 3\n0 0 inf 1 2 3\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// `before` is a command of the shell for the same process.
  [[nodiscard]] Answer run(const std::string& arguments, const std::string& before = ":") const {
    const std::string program = "'" + path_of("surfcastd") + "' " + arguments + " >out 2>err";
    const std::string command = "cd '" + folder_.string() + "' && " + before + " && " + program;
    Answer answer;
    const int status = std::system(command.c_str());
    answer.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    answer.out = content(folder_ / "out");
    answer.err = content(folder_ / "err");
    return answer;
  }

  fs::path folder_;
};

std::array<long, 3> nearest(const glm::dvec3& point) {
  return {std::lround(point.x), std::lround(point.y), std::lround(point.z)};
}

/// How far the positions of a model's finest surfels are from those of the points, which `points` holds by the whole
/// numbers nearest to them; infinite when it has others.
double largest_error(const fs::path& path, const std::map<std::array<long, 3>, glm::dvec3>& points) {
  const Result<model::ModelFile> model = model::ModelFile::open(path);
  EXPECT_TRUE(model);
  size_t found = 0;
  double largest = 0;
  for (size_t b = 0; model && b < model->blocks().size(); ++b) {
    if (model->tree().blocks()[b].level != 0) continue;
    const Result<model::DecodedBlock> block = model->decode(b);
    EXPECT_TRUE(block);
    for (size_t i = 0; block && i < block->size(); ++i) {
      const auto point = points.find(nearest(block->position(i)));
      if (point == points.end()) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, glm::distance(block->position(i), point->second));
      ++found;
    }
  }
  EXPECT_EQ(found, points.size());
  return largest;
}

/// One line on stderr that begins with the program's name.
void expect_one_line_error(const Answer& answer) {
  EXPECT_TRUE(answer.err.starts_with("surfcastd: ")) << answer.err;
  EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
}

TEST_F(SurfcastdTest, BuildsAModelAndSaysWhatItTook) {
  const Answer answer = run("build scan.ply --output model.surf --report report.json");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.err, "") << "no progress without a terminal";
  EXPECT_NE(answer.out.find("103 points read, 100 surfels, "), std::string::npos) << answer.out;
  const nlohmann::json report = nlohmann::json::parse(content(folder_ / "report.json"));
  EXPECT_EQ(report["points_read"], 103);
  EXPECT_EQ(report["surfels"], 100);
  EXPECT_EQ(report["bytes"], fs::file_size(folder_ / "model.surf"));
  EXPECT_EQ(report["dropped"]["not_finite"], 2);
  EXPECT_EQ(report["dropped"]["duplicates"], 1);
  EXPECT_GT(report["points_per_second"], 0);
  EXPECT_GT(report["peak_memory_bytes"], 1000000);
}

TEST_F(SurfcastdTest, SaysWhatBecameOfStatedRadii) {
  std::ofstream scan(folder_ / "radii.xyz");
  scan << "x y z radius\n";
  for (int i = 0; i < 400; ++i) scan << i % 20 << ' ' << i / 20 << " 0 0.5\n";
  scan.close();
  const Answer scaled = run("build radii.xyz --output model.surf --report report.json");
  ASSERT_EQ(scaled.exit_code, 0) << scaled.err;
  EXPECT_EQ(scaled.err, "");
  EXPECT_EQ(scaled.out.find("radii.xyz: radii of 0.47"), 0U) << scaled.out;
  const nlohmann::json radii = nlohmann::json::parse(content(folder_ / "report.json"))["radii"];
  ASSERT_EQ(radii.size(), 1U);
  EXPECT_EQ(radii[0]["input"], "radii.xyz");
  EXPECT_EQ(radii[0]["outcome"], "scaled");
  EXPECT_EQ(radii[0]["stated"], 400);
  EXPECT_NEAR(radii[0]["factor"].get<double>(), 2.28, 0.03);
  EXPECT_EQ(run("build radii.xyz --output model.surf --radii keep").out.find("radii.xyz: radii kept\n"), 0U);
  EXPECT_EQ(run("build radii.xyz --output model.surf --radii estimate").out.find("400 points read"), 0U);
  EXPECT_EQ(run("build radii.xyz --output model.surf --radii all").exit_code, 2);
}

/// A grid of 8 x 8 x 8 samples of x + y + z, in a file of text.
void write_ramp(const fs::path& path) {
  std::ofstream grid(path);
  grid << "NRRD0004\ntype: short\ndimension: 3\nsizes: 8 8 8\nencoding: ascii\n\n";
  for (int i = 0; i < 512; ++i) grid << i % 8 + i / 8 % 8 + i / 64 << '\n';
}

TEST_F(SurfcastdTest, MakesSurfelsOfAMesh) {
  std::ofstream(folder_ / "roof.obj") << "v 0 0 0 1 0 0\nv 4 0 1 1 0 0\nv 0 4 1 0 0 1\nf 1 2 3\n";
  const Answer answer = run("build roof.obj --mesh-spacing 0.1 --output model.surf --report report.json");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.out.find("roof.obj: 1 triangles, "), 0U) << answer.out;
  const nlohmann::json report = nlohmann::json::parse(content(folder_ / "report.json"));
  ASSERT_EQ(report["meshes"].size(), 1U);
  EXPECT_EQ(report["meshes"][0]["surfels"], report["surfels"]);
  EXPECT_TRUE(report["meshes"][0]["two_sided"]);
  EXPECT_NEAR(report["surfels"].get<double>(), 849, 60);  // an area of 8.49
  EXPECT_EQ(report["estimated"]["radii"], 0);
  const std::string summary = run("inspect model.surf").out;
  EXPECT_NE(summary.find("color bits: 8"), std::string::npos) << summary;
  EXPECT_NE(summary.find("sampling: even, from meshes"), std::string::npos) << summary;
}

TEST_F(SurfcastdTest, BuildsOneModelOfTheScansInAFolder) {
  std::filesystem::create_directory(folder_ / "scans");
  std::ofstream(folder_ / "scans" / "b.csv") << "x,y,z\n1,2,3\n4,6,8\n";
  std::ofstream(folder_ / "scans" / "a.XYZ") << "0 0 0\n1 0 0\n0 1 0\n";
  std::ofstream(folder_ / "scans" / "notes.md") << "not a scan\n";
  const Answer answer = run("build scans --output model.surf");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.out.find("5 points read"), 0U) << answer.out;
  EXPECT_NE(run("inspect model.surf").out.find("sources: a.XYZ, b.csv\n"), std::string::npos);
  std::ofstream(folder_ / "scans" / "brain.nii.gz") << "damaged";  // an extension of two parts counts, too
  EXPECT_NE(run("build scans --output model.surf").err.find("brain.nii.gz: "), std::string::npos);
  std::filesystem::create_directory(folder_ / "empty");
  EXPECT_NE(run("build empty --output model.surf").err.find("empty: a folder without a file that a model is built of"),
            std::string::npos);
}

TEST_F(SurfcastdTest, RenderTellsOfOptionsWithoutEffect) {
  std::ofstream(folder_ / "scan.csv") << "x,y,z\n0,0,0\n1,0,0\n0,1,0\n";
  ASSERT_EQ(run("build scan.csv --output scan.surf").exit_code, 0);
  const std::string picture = "render scan.surf --resolution 8,8 --output out.png";
  const Answer unused = run(picture + " --lights '0.1,0.2,32;0,0,-1,1' --transfer gray --glyph superquadric");
  ASSERT_EQ(unused.exit_code, 0) << unused.err;
  EXPECT_NE(unused.err.find("--lights without effect: the model has no ellipsoids"), std::string::npos) << unused.err;
  EXPECT_NE(unused.err.find("--transfer without effect: the model has no volume"), std::string::npos);
  EXPECT_NE(unused.err.find("options of glyphs without effect"), std::string::npos);
  EXPECT_EQ(run(picture + " --shading lit").err.find("without effect"), std::string::npos);
}

TEST_F(SurfcastdTest, InspectsFilesThatModelsAreBuiltOf) {
  std::ofstream(folder_ / "scan.csv") << "x,y,z,intensity\n1,2,3,7\n4,6,8,9\n";
  const nlohmann::json scan = nlohmann::json::parse(run("inspect scan.csv --json").out);
  EXPECT_EQ(scan["kind"], "scan");
  EXPECT_EQ(scan["points"], 2);
  EXPECT_EQ(scan["bounds_max"], nlohmann::json({4, 6, 8}));
  EXPECT_EQ(scan["attributes"], nlohmann::json({"intensity uint8"}));
  EXPECT_NE(run("inspect scan.csv").out.find("bounds_min: 1.0 2.0 3.0\n"), std::string::npos);
  std::ofstream(folder_ / "grid.nrrd") << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspacings: 1 1 2\n"
                                          "encoding: raw\n\n12345678";
  const std::string grid = run("inspect grid.nrrd").out;
  EXPECT_NE(grid.find("kind: volume\n"), std::string::npos) << grid;
  EXPECT_NE(grid.find("size: 2 2 2\n"), std::string::npos) << grid;
  std::ofstream(folder_ / "letter.txt") << "Dear reader,\n";
  const Answer letter = run("inspect letter.txt");
  EXPECT_EQ(letter.exit_code, 1);
  EXPECT_NE(letter.err.find("letter.txt: not a Surfcast model"), std::string::npos) << letter.err;
  EXPECT_NE(run("inspect scan.csv --verify").err.find("not a Surfcast model"), std::string::npos);
}

TEST_F(SurfcastdTest, ColoursAScanWithAPictureFromAbove) {
  std::ofstream(folder_ / "scan.xyz") << "1 1 0\n2 1 0\n1 2 0\n2 2 0\n";
  std::ofstream(folder_ / "photo.bmp", std::ios::binary)
      << std::string("BM\x3A\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\1\0\0\0\1\0\0\0\1\0\x18\0", 30) << std::string(24, '\0')
      << std::string("\0\0\xFF\0", 4);
  std::ofstream(folder_ / "photo.wld") << "4 0 0 -4 2 2\n";
  const Answer answer = run("colorize scan.xyz --orthophoto photo.bmp --output model.surf");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.out.find("4 points have the pictures' colours, 0 are hidden from them, 0 outside\n"), 0U)
      << answer.out;
  const Answer without = run("colorize scan.xyz --orthophoto none.tif --output model.surf");
  EXPECT_EQ(without.exit_code, 1);
  EXPECT_EQ(without.err.find("surfcastd: none.tif"), 0U) << without.err;
}

TEST_F(SurfcastdTest, ExportsAPartOfAScan) {
  std::ofstream(folder_ / "scan.xyz") << "1 1 0\n2 1 0\n1 2 0\n2 2 5\n9 9 9\n";
  const Answer answer =
      run("export scan.xyz --output part.csv --corridor 3,0,1,5,1@0,4 --bounds 0,0,9,1 --bounds=0,2,1,2");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.out.find("3 points, "), 0U) << answer.out;
  EXPECT_EQ(content(folder_ / "part.csv"), "x,y,z\n1,1,0\n2,1,0\n1,2,0\n");
  const Answer empty = run("export scan.xyz --output none.las --bounds 50,50,60,60");
  EXPECT_EQ(empty.exit_code, 1);
  expect_one_line_error(empty);
  EXPECT_FALSE(fs::exists(folder_ / "none.las"));
  for (const char* flag : {"--bounds 1,2,3", "--corridor 3,0,0", "--corridor 3,0,0,1,1@2", "--corridor -1,0,0,1,1"}) {
    EXPECT_EQ(run("export scan.xyz --output part.csv " + std::string(flag)).exit_code, 2) << flag;
  }
}

/// The lines of a text, sorted.
std::vector<std::string> sorted_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::sort(lines.begin(), lines.end());
  return lines;
}

TEST_F(SurfcastdTest, LasComesBackFromItsModelEqualInEveryField) {
  std::ofstream scan(folder_ / "scan.csv");
  scan << "x,y,z,red,green,blue,intensity,classification,return_number,number_of_returns,gps_time,point_source_id,"
          "scan_angle,user_data,height_above_ground\n";
  scan.precision(17);
  for (int i = 0; i < 3000; ++i) {
    scan << 448000 + i % 60 * 0.25 << ',' << 5411000 + i / 60 * 0.25 << ',' << 12 + i % 7 * 0.001 << ',' << i % 256
         << ',' << i % 101 << ",7," << i << ',' << i % 9 << ',' << 1 + i % 3 << ",3," << 1e8 + i * 1e-6 << ',' << i % 5
         << ',' << i % 90 - 45 << ',' << i % 250 << ',' << i * 0.5 << "\n";
  }
  scan.close();
  ASSERT_EQ(run("export scan.csv --output scan.las").exit_code, 0);
  ASSERT_EQ(run("build scan.las --output model.surf").exit_code, 0);
  for (const std::string extension : {"las", "laz", "copc.laz"}) {
    const Answer exported = run("export model.surf --output back." + extension);
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
    EXPECT_EQ(exported.err, "");
    EXPECT_EQ(exported.out.find("3000 points, "), 0U) << exported.out;
    ASSERT_EQ(run("export scan.las --output scan_table.csv").exit_code, 0);
    ASSERT_EQ(run("export back." + extension + " --output back_table.csv").exit_code, 0);
    const std::string table = content(folder_ / "scan_table.csv");
    EXPECT_EQ(table.substr(0, table.find('\n')), content(folder_ / "back_table.csv").substr(0, table.find('\n')));
    EXPECT_EQ(sorted_lines(content(folder_ / "back_table.csv")), sorted_lines(table));
  }
}

TEST_F(SurfcastdTest, PointsOfAScanInDegreesComeBackInDegrees) {
  std::ofstream scan(folder_ / "scan.csv");
  scan << "x,y,z\n";
  scan.precision(17);
  for (int i = 0; i < 900; ++i) scan << 9.1 + i % 30 * 1e-5 << ',' << 48.7 + i / 30 * 1e-5 << ",250\n";
  scan.close();
  const Answer built = run("build scan.csv --crs EPSG:4326 --output model.surf");
  ASSERT_EQ(built.exit_code, 0) << built.err;
  ASSERT_EQ(run("export model.surf --output back.csv").exit_code, 0);
  std::istringstream lines(content(folder_ / "back.csv"));
  std::string line;
  std::getline(lines, line);
  std::set<int> found;
  while (std::getline(lines, line)) {
    double x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &x, &y, &z), 3) << line;
    const double column = (x - 9.1) / 1e-5, row = (y - 48.7) / 1e-5;
    EXPECT_NEAR(column, std::round(column), 2e-3) << "a millimetre is 0.0014 of a step";
    EXPECT_NEAR(row, std::round(row), 2e-3);
    EXPECT_NEAR(z, 250, 2e-3);
    found.insert(static_cast<int>(std::lround(column) + 30 * std::lround(row)));
  }
  EXPECT_EQ(found.size(), 900U);
  const Answer picked = run("pick model.surf --pixel 640,360 --json");
  ASSERT_EQ(picked.exit_code, 0) << picked.err;
  const nlohmann::json pick = nlohmann::json::parse(picked.out);
  ASSERT_TRUE(pick["hit"]);
  EXPECT_GT(pick["position"][0], 400'000) << "metres";
  EXPECT_NEAR(pick["source_position"][0], 9.10015, 2e-4);
  EXPECT_NEAR(pick["source_position"][1], 48.70015, 2e-4);
}

TEST_F(SurfcastdTest, ExportsARegionOfAModelAndRefusesVolumes) {
  ASSERT_EQ(run("build scan.ply --output model.surf").exit_code, 0);
  const Answer answer = run("export model.surf --output part.csv --bounds 2,2,3,4");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(sorted_lines(content(folder_ / "part.csv")),
            sorted_lines("x,y,z,red,green,blue\n2,2,0,255,22,0\n3,2,0,255,23,0\n2,3,0,255,32,0\n3,3,0,255,33,0\n"
                         "2,4,0,255,42,0\n3,4,0,255,43,0\n"));
  const Answer empty = run("export model.surf --output none.las --bounds 50,50,60,60");
  EXPECT_EQ(empty.exit_code, 1);
  EXPECT_EQ(empty.err, "surfcastd: model.surf: has no points in the selection\n");
  EXPECT_FALSE(fs::exists(folder_ / "none.las"));
  write_ramp(folder_ / "ramp.nrrd");
  ASSERT_EQ(run("build ramp.nrrd --output ramp.surf").exit_code, 0);
  const Answer volume = run("export ramp.surf --output ramp.csv");
  EXPECT_EQ(volume.exit_code, 1);
  EXPECT_EQ(volume.err, "surfcastd: ramp.surf: has no points, but blocks of kind grid\n");
}

TEST_F(SurfcastdTest, MakesSurfacesOfAVolume) {
  write_ramp(folder_ / "ramp.nrrd");
  const Answer answer = run("build ramp.nrrd --iso 9.5,200,30,4 --iso=4 --output model.surf --report report.json");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.err, "");
  EXPECT_EQ(answer.out.find("ramp.nrrd: "), 0U) << answer.out;
  EXPECT_NE(answer.out.find(" points of the surface at 9.5\n"), std::string::npos) << answer.out;
  const nlohmann::json report = nlohmann::json::parse(content(folder_ / "report.json"));
  ASSERT_EQ(report["surfaces"].size(), 2U);
  EXPECT_EQ(report["surfaces"][1]["input"], "ramp.nrrd");
  EXPECT_EQ(report["surfaces"][1]["value"], 4);
  EXPECT_EQ(report["surfaces"][1]["lost"], 0);
  EXPECT_EQ(report["scatter"], 0);
  EXPECT_TRUE(report["oriented"]);
  const std::string summary = run("inspect model.surf").out;
  EXPECT_NE(summary.find("iso_value"), std::string::npos) << summary;
}

TEST_F(SurfcastdTest, BuildsInspectsAndPicksTensors) {
  std::ofstream(folder_ / "field.nrrd") << "NRRD0004\ntype: float\ndimension: 4\nsizes: 7 2 1 1\nkinds: "
                                           "3D-masked-symmetric-matrix space space space\nencoding: ascii\n\n"
                                           "1 3 0 0 2 0 1\n0 3 0 0 2 0 1\n";
  const Answer built = run("build field.nrrd --output field.surf --report report.json");
  ASSERT_EQ(built.exit_code, 0) << built.err;
  EXPECT_EQ(built.out.find("2 samples read, 1 ellipsoids, "), 0U) << built.out;
  EXPECT_NE(built.err.find("field: 1 of 2 glyphs cannot be drawn: 1 with a confidence below 0.5"), std::string::npos);
  const nlohmann::json report = nlohmann::json::parse(content(folder_ / "report.json"));
  EXPECT_EQ(report["ellipsoids"][0]["drawn"], 1);
  const nlohmann::json summary = nlohmann::json::parse(run("inspect field.surf --json --verify").out);
  EXPECT_EQ(summary["kinds"][0]["kind"], "ellipsoid");
  EXPECT_EQ(summary["kinds"][0]["count"], 1);
  EXPECT_NEAR(summary["ellipsoids"][0]["mean_fa"].get<double>(), 0.46291, 1e-5);
  EXPECT_EQ(summary["ellipsoids"][0]["masked"], 1);
  const Answer picked =
      run("pick field.surf --pixel 32,32 --resolution 65,65 --json --camera-position 0,0,10 "
          "--camera-focal-point 0,0,0 --camera-view-up 0,1,0");
  ASSERT_EQ(picked.exit_code, 0) << picked.err;
  EXPECT_NE(picked.out.find("eigenvalue_1"), std::string::npos) << picked.out;
  EXPECT_EQ(run("build field.nrrd --kind teapot --output field.surf").exit_code, 2);
}

TEST_F(SurfcastdTest, ASurfaceThatTheVolumeDoesNotHaveIsAnError) {
  write_ramp(folder_ / "ramp.nrrd");
  const Answer beyond = run("build ramp.nrrd --iso -3 --output model.surf");
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_EQ(beyond.err, "surfcastd: ramp.nrrd: no surface at -3: the samples are from 0 to 21\n");
  EXPECT_FALSE(fs::exists(folder_ / "model.surf"));
  const Answer scan = run("build scan.ply --iso 3 --output model.surf");
  EXPECT_EQ(scan.exit_code, 1);
  EXPECT_EQ(scan.err, "surfcastd: scan.ply: --iso needs a volume, and no input is one\n");
}

TEST_F(SurfcastdTest, JoinsSeveralScansIntoOneModel) {
  std::ofstream(folder_ / "more.xyz") << "0 0 5\n1 0 5\n0 1 5\n1 1 5\n";
  ASSERT_EQ(run("build scan.ply more.xyz --output model.surf").exit_code, 0);
  const nlohmann::json model = nlohmann::json::parse(run("inspect model.surf --json").out);
  EXPECT_EQ(model["surfels"], 104);
  EXPECT_EQ(model["sources"], (nlohmann::json{"scan.ply", "more.xyz"}));
}

TEST_F(SurfcastdTest, AddsScansToAModel) {
  std::ofstream(folder_ / "east.csv") << "x,y,z,red,green,blue\n10,0,0,1,2,3\n11,0,0,1,2,3\n11,1,0,1,2,3\n";
  ASSERT_EQ(run("build scan.ply --output model.surf").exit_code, 0);
  const Answer added = run("build east.csv --into model.surf --report report.json");
  ASSERT_EQ(added.exit_code, 0) << added.err;
  EXPECT_NE(added.out.find("added to 100 surfels"), std::string::npos) << added.out;
  EXPECT_EQ(nlohmann::json::parse(content(folder_ / "report.json"))["appended"]["surfels_before"], 100);
  const Answer inspected = run("inspect model.surf");
  EXPECT_NE(inspected.out.find("surfels: 103"), std::string::npos) << inspected.out;
  EXPECT_NE(inspected.out.find("sources: scan.ply, east.csv"), std::string::npos) << inspected.out;
}

TEST_F(SurfcastdTest, WhatCannotBeAddedLeavesTheModelAsItWas) {
  ASSERT_EQ(run("build scan.ply --output model.surf").exit_code, 0);
  const std::string before = content(folder_ / "model.surf");
  std::ofstream(folder_ / "more.csv") << "x,y,z,temperature\n10,0,0,1\n11,0,0,2\n11,1,0,3\n";
  std::ofstream(folder_ / "text.csv") << "no table\n";
  for (const std::string arguments :
       {"build more.csv --into model.surf", "build text.csv --into model.surf", "build none.las --into model.surf",
        "build scan.ply --into none.surf", "build scan.ply --into model.surf --output other.surf", "build scan.ply"}) {
    const Answer refused = run(arguments);
    EXPECT_NE(refused.exit_code, 0) << arguments;
    EXPECT_FALSE(refused.err.empty()) << arguments;
  }
  EXPECT_NE(run("build more.csv --into model.surf").err.find("more.csv: has the attribute temperature"),
            std::string::npos);
  EXPECT_EQ(content(folder_ / "model.surf"), before);
}

TEST_F(SurfcastdTest, InspectsAModelForPeopleAndPrograms) {
  ASSERT_EQ(run("build scan.ply --output model.surf").exit_code, 0);
  const Answer text = run("inspect model.surf --verify");
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_NE(text.out.find("surfels: 100\n"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("verified"), std::string::npos);
  const nlohmann::json model = nlohmann::json::parse(run("inspect model.surf --json --verify").out);
  EXPECT_EQ(model["surfels"], 100);
  EXPECT_EQ(model["color_bits"], 8);
  EXPECT_EQ(model["levels"][0]["surfels"], 100);
  EXPECT_NEAR(model["bounds"]["max"][0].get<double>(), 9, 0.01);
}

size_t occurrences(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST_F(SurfcastdTest, InspectsSeveralModelsAndAllOfThemAsOne) {
  std::ofstream(folder_ / "more.xyz") << "0 0 5\n1 0 5\n0 1 5\n1 1 5\n";
  ASSERT_EQ(run("build scan.ply --output a.surf").exit_code, 0);
  ASSERT_EQ(run("build more.xyz --output b.surf").exit_code, 0);
  const Answer answer = run("inspect a.surf b.surf --json");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.err, "");
  const nlohmann::json models = nlohmann::json::parse(answer.out);
  EXPECT_EQ(models["model"], "a+b");
  EXPECT_EQ(models["surfels"], 104);
  EXPECT_EQ(models["bytes"], fs::file_size(folder_ / "a.surf") + fs::file_size(folder_ / "b.surf"));
  EXPECT_NEAR(models["bounds"]["max"][2].get<double>(), 5, 0.01);
  ASSERT_EQ(models["members"].size(), 2U);
  EXPECT_EQ(models["members"][0], nlohmann::json::parse(run("inspect a.surf --json").out));
  EXPECT_EQ(models["members"][1], nlohmann::json::parse(run("inspect b.surf --json").out));
  EXPECT_EQ(run("inspect a.surf+b.surf --json").out, answer.out);
  const std::string text = run("inspect a.surf b.surf --verify").out;
  EXPECT_EQ(text.find("model: a.surf\n"), 0U);
  EXPECT_LT(text.find("\nmodel: b.surf\n"), text.find("\nmodel: a+b\n")) << text;
  EXPECT_NE(text.find("\nsurfels: 104\n"), std::string::npos);
  EXPECT_EQ(occurrences(text, "verified: every block\n"), 2U);
  const Answer scan = run("inspect a.surf more.xyz");
  EXPECT_EQ(scan.exit_code, 1);
  EXPECT_EQ(scan.err.find("surfcastd: more.xyz: "), 0U) << scan.err;
  EXPECT_EQ(occurrences(scan.err, "\n"), 1U);
}

TEST_F(SurfcastdTest, ExportsThePointsOfSeveralModels) {
  std::ofstream(folder_ / "more.xyz") << "0 0 5\n1 0 5\n0 1 5\n1 1 5\n";
  write_ramp(folder_ / "ramp.nrrd");
  for (const char* build : {"scan.ply --output a.surf", "more.xyz --output b.surf", "ramp.nrrd --output ramp.surf"}) {
    ASSERT_EQ(run("build " + std::string(build)).exit_code, 0) << build;
  }
  ASSERT_EQ(run("export a.surf --output a.csv").exit_code, 0);
  const std::string alone = content(folder_ / "a.csv");
  const Answer both = run("export a.surf b.surf --output both.csv");
  ASSERT_EQ(both.exit_code, 0) << both.err;
  EXPECT_EQ(both.err, "");
  EXPECT_EQ(both.out.find("104 points, "), 0U) << both.out;
  // What has no colours is grey, as if both were built as one.
  EXPECT_EQ(sorted_lines(content(folder_ / "both.csv")),
            sorted_lines(alone + "0,0,5,128,128,128\n1,0,5,128,128,128\n0,1,5,128,128,128\n1,1,5,128,128,128\n"));
  const Answer part = run("export a.surf+ramp.surf --output part.csv");
  ASSERT_EQ(part.exit_code, 0) << part.err;
  EXPECT_EQ(content(folder_ / "part.csv"), alone);
  EXPECT_NE(part.err.find("part.csv: left out: ramp: has no points\n"), std::string::npos) << part.err;
  EXPECT_EQ(occurrences(part.err, "\n"), 1U);
  const Answer none = run("export ramp.surf ramp.surf --output none.csv");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_EQ(none.err, "surfcastd: none of the models has points that can be written\n");
  const Answer scan = run("export a.surf more.xyz --output none.csv");
  EXPECT_EQ(scan.exit_code, 1);
  EXPECT_EQ(scan.err.find("surfcastd: more.xyz: "), 0U) << scan.err;
  EXPECT_FALSE(fs::exists(folder_ / "none.csv"));
}

/// 10 by 10 points at distances of 1 m about 12 degrees east, in a zone of UTM; `also` adds as many far away.
void write_site(const fs::path& path, double easting, double also) {
  std::ofstream scan(path);
  scan.precision(12);
  scan << "x,y,z\n";
  for (int i = 0; i < (also > 0 ? 200 : 100); ++i) {
    scan << easting + i % 10 + (i < 100 ? 0 : also) << ',' << 5'320'000 + i / 10 % 10 << ",250\n";
  }
}

TEST_F(SurfcastdTest, ModelsOfSeveralSystemsAreStatedInTheFirst) {
  write_site(folder_ / "here.csv", 723'700, 0);
  write_site(folder_ / "near.csv", 276'300, 0);
  write_site(folder_ / "wide.csv", 276'300, 90'000);
  ASSERT_EQ(run("build here.csv --crs EPSG:25832 --output here.surf").exit_code, 0);
  ASSERT_EQ(run("build near.csv --crs EPSG:25833 --output near.surf").exit_code, 0);
  ASSERT_EQ(run("build wide.csv --crs EPSG:25833 --output wide.surf").exit_code, 0);
  const Answer answer = run("export here.surf near.surf wide.surf --output all.csv");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.out.find("200 points, "), 0U) << answer.out;
  EXPECT_NE(answer.err.find("near: brought into the system of the first model block by block, to within 0.25 of the "
                            "spacing of its points\n"),
            std::string::npos)
      << answer.err;
  EXPECT_NE(answer.err.find("left out: wide: "), std::string::npos);
  EXPECT_EQ(occurrences(answer.err, "\n"), 2U);
  std::istringstream lines(content(folder_ / "all.csv"));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) EXPECT_NEAR(std::stod(line), 723'700, 5'000);
  EXPECT_EQ(nlohmann::json::parse(run("inspect here.surf near.surf --json").out)["surfels"], 200);
  const Answer inspected = run("inspect here.surf wide.surf --json");
  ASSERT_EQ(inspected.exit_code, 0) << inspected.err;
  EXPECT_NE(inspected.err.find("no totals: wide: "), std::string::npos) << inspected.err;
  const nlohmann::json models = nlohmann::json::parse(inspected.out);
  EXPECT_FALSE(models.contains("surfels"));
  EXPECT_EQ(models["members"].size(), 2U);
}

TEST_F(SurfcastdTest, AKindOfBlocksThatItDoesNotKnowIsCountedAndNamed) {
  fs::copy_file(fs::path(path_of("tests/data")) / "square-and-balls-v3.surf", folder_ / "model.surf");
  const nlohmann::json model = nlohmann::json::parse(run("inspect model.surf --json").out);
  EXPECT_EQ(model["kinds"], nlohmann::json::parse(R"([{"kind": "surfel", "blocks": 1, "count": 144},
                                                      {"kind": "ball", "blocks": 3, "count": 4}])"));
  EXPECT_NE(run("inspect model.surf").out.find("kind ball: 4 in 3 blocks\n"), std::string::npos);
  for (const char* command : {"inspect model.surf --verify", "render model.surf --output out.png"}) {
    const Answer answer = run(command);
    EXPECT_EQ(answer.exit_code, 1) << command;
    const std::string reason = "surfcastd: model.surf: has blocks of the unknown kind 'ball'\n";
    EXPECT_TRUE(answer.err.ends_with(reason)) << command << ": " << answer.err;  // what is logged stands before it
  }
}

TEST_F(SurfcastdTest, VerifyFindsADamagedBlock) {
  ASSERT_EQ(run("build scan.ply --output model.surf").exit_code, 0);
  std::fstream model(folder_ / "model.surf", std::ios::in | std::ios::out | std::ios::binary);
  model.seekp(100);
  model.put('\x5a');
  model.close();
  EXPECT_EQ(run("inspect model.surf").exit_code, 0) << "the tables are whole";
  const Answer answer = run("inspect model.surf --verify");
  EXPECT_EQ(answer.exit_code, 1);
  expect_one_line_error(answer);
  EXPECT_NE(answer.err.find("model.surf: block 0: damaged"), std::string::npos) << answer.err;
}

TEST_F(SurfcastdTest, PrecisionBoundsThePositionError) {
  // Positions on no lattice, near to the whole numbers that tell which point is which.
  std::map<std::array<long, 3>, glm::dvec3> points;
  std::ofstream scan(folder_ / "survey.xyz");
  scan.precision(17);
  for (int i = 0; i < 400; ++i) {
    const glm::dvec3 whole(i % 20, i / 20, 7);
    const glm::dvec3 point = whole + 0.2 * glm::dvec3(std::sin(i), std::sin(2.1 * i), std::sin(3.7 * i));
    points[nearest(point)] = point;
    scan << point.x << ' ' << point.y << ' ' << point.z << '\n';
  }
  scan.close();
  for (const double precision : {0.1, 0.003, 1e-6}) {
    ASSERT_EQ(run("build survey.xyz --output model.surf --precision " + std::to_string(precision)).exit_code, 0);
    const double error = largest_error(folder_ / "model.surf", points);
    EXPECT_LE(error, precision);
    EXPECT_GT(error, precision / 10) << "bytes are spent on digits that nobody asked for";
  }
}

TEST_F(SurfcastdTest, FailuresNameTheFileAndLeaveNothingBehind) {
  std::ofstream(folder_ / "broken.ply") << "ply\nformat ascii 1.0\nelement vertex 5\n";
  std::ofstream(folder_ / "empty.ply").flush();
  for (const std::string input : {"absent.ply", "broken.ply", "empty.ply"}) {
    const Answer answer = run("build " + input + " --output model.surf");
    EXPECT_EQ(answer.exit_code, 1) << input;
    expect_one_line_error(answer);
    EXPECT_NE(answer.err.find(input), std::string::npos) << answer.err;
    EXPECT_FALSE(fs::exists(folder_ / "model.surf"));
  }
}

TEST_F(SurfcastdTest, AFolderThatIsMissingIsFoundBeforeTheScanIsRead) {
  const Answer answer = run("build absent.ply --output nowhere/model.surf");
  EXPECT_EQ(answer.exit_code, 1);
  EXPECT_NE(answer.err.find("nowhere/model.surf: no such folder"), std::string::npos) << answer.err;
}

TEST_F(SurfcastdTest, ABuildNeverOverwritesItsInput) {
  const std::string before = content(folder_ / "scan.ply");
  const Answer answer = run("build scan.ply --output ./scan.ply");
  EXPECT_EQ(answer.exit_code, 1);
  expect_one_line_error(answer);
  EXPECT_EQ(content(folder_ / "scan.ply"), before);
}

TEST_F(SurfcastdTest, AFailedBuildKeepsTheOldModel) {
  ASSERT_EQ(run("build scan.ply --output model.surf").exit_code, 0);
  const std::string before = content(folder_ / "model.surf");
  EXPECT_EQ(run("build absent.ply --output model.surf").exit_code, 1);
  EXPECT_EQ(content(folder_ / "model.surf"), before);
}

TEST_F(SurfcastdTest, ADiskThatIsFullIsOneLineAndKeepsTheOldModel) {
  std::ofstream(folder_ / "model.surf") << "an old model";
  const Answer answer = run("build scan.ply --output model.surf", "ulimit -f 1");  // files end at 512 or 1024 bytes
  EXPECT_EQ(answer.exit_code, 1);
  expect_one_line_error(answer);
  EXPECT_NE(answer.err.find("model.surf: cannot write: File too large"), std::string::npos) << answer.err;
  EXPECT_EQ(content(folder_ / "model.surf"), "an old model");
  const auto files = std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  EXPECT_EQ(files, 4) << "the scan, the model, and what the program said";
}

TEST_F(SurfcastdTest, AMemoryBudgetIsASizeThatSuffices) {
  EXPECT_EQ(run("build scan.ply --output model.surf --memory lots").exit_code, 2);
  const Answer answer = run("build scan.ply --output model.surf --memory 10M");
  EXPECT_EQ(answer.exit_code, 1);
  expect_one_line_error(answer);
  EXPECT_NE(answer.err.find("at least "), std::string::npos) << answer.err;
  EXPECT_EQ(run("build scan.ply --output model.surf --memory 1G --report report.json").exit_code, 0);
  const nlohmann::json report = nlohmann::json::parse(content(folder_ / "report.json"));
  EXPECT_EQ(report["memory_budget_bytes"], 1 << 30);
  EXPECT_EQ(report["parts"], 1);
  EXPECT_TRUE(report["stage_seconds"].contains("making surfels"));
}

TEST_F(SurfcastdTest, AWrongCommandLineIsTwo) {
  for (const char* arguments :
       {"", "nonsense", "build scan.ply", "build --output model.surf", "build scan.ply --output m.surf --precision 0",
        "build scan.ply --output m.surf --iso few", "build scan.ply --output m.surf --iso 3,1",
        "build scan.ply --output m.surf --iso 3,0,0,256", "build scan.ply --output m.surf --iso 3,1,2,3,0.5",
        "build scan.ply --output m.surf --precision few", "build scan.ply --output m.surf --nonsense", "inspect"}) {
    const Answer answer = run(arguments);
    EXPECT_EQ(answer.exit_code, 2) << arguments;
    expect_one_line_error(answer);
  }
}

TEST_F(SurfcastdTest, HelpIsNoFailure) {
  for (const char* arguments : {"--help", "build --help", "inspect --help"}) {
    const Answer answer = run(arguments);
    EXPECT_EQ(answer.exit_code, 0) << arguments;
    EXPECT_FALSE(answer.out.empty());
  }
}

TEST_F(SurfcastdTest, TheSameScanGivesTheSameBytes) {
  ASSERT_EQ(run("build scan.ply --output a.surf").exit_code, 0);
  ASSERT_EQ(run("build scan.ply --output b.surf").exit_code, 0);
  EXPECT_EQ(content(folder_ / "a.surf"), content(folder_ / "b.surf"));
}

TEST_F(SurfcastdTest, PicksThePointOfTheScanUnderAPixel) {
  std::ofstream scan(folder_ / "survey.xyz");
  scan.precision(12);
  scan << "x y z intensity classification\n";
  for (int i = 0; i < 400; ++i) scan << 448262.25 + i % 20 << ' ' << 5411932.5 + i / 20 << " 7 " << i << " 2\n";
  scan.close();
  const std::string above =
      " --pixel 50,50 --resolution 100,100 --camera-position 448271.25,5411941.5,40 --camera-focal-point "
      "448271.25,5411941.5,0 --camera-view-up 0,1,0 ";
  const Answer answer = run("pick survey.xyz --cache cache --json" + above);
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const nlohmann::json pick = nlohmann::json::parse(answer.out);
  EXPECT_TRUE(pick["hit"]);
  EXPECT_EQ(pick["position"], (nlohmann::json{448271.25, 5411941.5, 7.0}));
  EXPECT_EQ(pick["attributes"]["intensity"], 189);
  EXPECT_EQ(pick["attributes"]["classification"], 2);
  EXPECT_EQ(pick["distance"], 33);
  const Answer hidden = run("pick survey.xyz --cache cache --hide-classes 2" + above);
  EXPECT_EQ(hidden.out, "hit: no\n");
  EXPECT_EQ(run("pick survey.xyz --cache cache --clip-out 448271,5411941,0,448272,5411942,9" + above).exit_code, 0);
}

TEST_F(SurfcastdTest, PicksThatMeanNothingAreRefused) {
  ASSERT_EQ(run("build scan.ply --output model.surf").exit_code, 0);
  EXPECT_EQ(run("pick model.surf").exit_code, 2);
  EXPECT_EQ(run("pick model.surf --pixel 3").exit_code, 2);
  const Answer outside = run("pick model.surf --pixel 64,3 --resolution 64,64");
  EXPECT_EQ(outside.exit_code, 1);
  expect_one_line_error(outside);
}

TEST_F(SurfcastdTest, InspectStatesRangesAndClasses) {
  std::ofstream(folder_ / "survey.xyz") << "x y z intensity classification\n0 0 0 5 2\n1 0 0 7 2\n0 1 0 9 6\n";
  ASSERT_EQ(run("build survey.xyz --output model.surf").exit_code, 0);
  const nlohmann::json model = nlohmann::json::parse(run("inspect model.surf --json").out);
  EXPECT_EQ(model["ranges"][0]["attribute"], "intensity");
  EXPECT_EQ(model["ranges"][0]["smallest"], 5);
  EXPECT_EQ(model["ranges"][0]["largest"], 9);
  EXPECT_EQ(model["classes"], nlohmann::json::parse(R"([{"code": 2, "surfels": 2}, {"code": 6, "surfels": 1}])"));
  EXPECT_NE(run("inspect model.surf").out.find("class 6: 1 surfels\n"), std::string::npos);
}

TEST_F(SurfcastdTest, TellsItsVersion) {
  const Answer answer = run("--version");
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_EQ(answer.out, "surfcastd " SURFCAST_VERSION "\n");
  EXPECT_EQ(answer.err, "");
}

constexpr const char* kCommands =
    "build, build-blocks, build-merge, build-part, build-plan, build-signs, colorize, export, gpus, healthcheck, "
    "inspect, "
    "pick, render, serve";

TEST_F(SurfcastdTest, AWrongCommandIsAnsweredWithTheRightOnes) {
  const Answer answer = run("bild scan.ply");
  EXPECT_EQ(answer.exit_code, 2);
  expect_one_line_error(answer);
  EXPECT_NE(answer.err.find("'bild' (did you mean 'build'?)"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find(kCommands), std::string::npos) << answer.err;
}

TEST_F(SurfcastdTest, ACommandLineWithoutACommandNamesThem) {
  const Answer answer = run("");
  EXPECT_EQ(answer.exit_code, 2);
  expect_one_line_error(answer);
  EXPECT_NE(answer.err.find("a command is missing"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find(kCommands), std::string::npos) << answer.err;
}

/// OpenImageIO, which was linked once, brought 247 libraries with it.
TEST_F(SurfcastdTest, LoadsFewLibraries) {
  const Answer answer = run("--help", "export LD_TRACE_LOADED_OBJECTS=1");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_NE(answer.out.find("libdraco"), std::string::npos) << "the list of the loader: " << answer.out;
  EXPECT_LE(std::count(answer.out.begin(), answer.out.end(), '\n'), 30) << answer.out;
}

}  // namespace
}  // namespace surfcast::cmd
