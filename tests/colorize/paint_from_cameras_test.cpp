#include "colorize/paint_from_cameras.h"

#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "colorize/xyz_line.h"
#include "mesh/mesh_files.h"

namespace surfcast::colorize {
namespace {

using mesh::MeshFolder;
using mesh::Texel;

constexpr double kHeight = 20;  ///< of the camera over the middle of the ground
constexpr double kFocal = 300;

/// Smooth colours of the ground.
Texel ground_at(double x, double y) {
  const auto level = [](double wave) { return static_cast<uint8_t>(std::lround(128 + 100 * std::sin(wave))); };
  return {level(x * 0.9), level(y * 0.8), level((x + y) * 0.4), 255};
}

const std::string kCamera =
    R"({"image": "photo.tga", "position": [5, 5, 20], "rotation": [1, 0, 0, 0, -1, 0, 0, 0, -1],
        "focal": [300, 300], "principal_point": [100, 100])";

std::vector<PhotoCamera> cameras_in(const MeshFolder& folder, const std::string& more = "}") {
  folder.write("photo.tga", mesh::targa(200, 200, [](int i, int j) {
                 return ground_at(5 + (i + 0.5 - 100) / kFocal * kHeight, 5 - (j + 0.5 - 100) / kFocal * kHeight);
               }));
  const std::string text = R"({"cameras": [)" + kCamera + more + "]}";
  const Result<std::vector<PhotoCamera>> cameras = parse_cameras(text, folder.path() / "bundle.json");
  EXPECT_TRUE(cameras) << cameras.error().message;
  return *cameras;
}

TEST(PaintFromCameras, GroundIsReadBackAndABoardHidesWhatIsBehindIt) {
  const MeshFolder folder;
  const std::vector<PhotoCamera> cameras = cameras_in(folder);
  std::string rows;
  for (int j = 0; j < 200; ++j) {
    for (int i = 0; i < 200; ++i) {
      const double x = 0.05 * i + 0.02;
      const double y = 0.05 * j + 0.03;
      rows += testing::xyz_line(x, y, 0);
      if (std::abs(x - 5) < 1 && std::abs(y - 5) < 1) rows += testing::xyz_line(x, y, 4);
    }
  }
  const std::filesystem::path file = folder.write("scan.xyz", rows);
  const std::array inputs{file};
  const auto built = builder::build_model(inputs, folder.path() / "m.surf", {}, [](const builder::BuildStep&) {});
  ASSERT_TRUE(built) << built.error().message;
  const auto model = model::ModelFile::open(folder.path() / "m.surf");
  ASSERT_TRUE(model);
  const auto photos = take_photos(cameras, *model, {});
  ASSERT_TRUE(photos) << photos.error().message;
  PaintReport report;
  const auto painted = paint_scan(scan::ScanStream::open(file).value(), file, painter_of(*photos, 0.2), {}, report);
  ASSERT_TRUE(painted) << painted.error().message;
  const scan::ScanPoints points = painted->read(0).value();
  double error = 0;
  uint64_t compared = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3& p = points.positions[i];
    const glm::u16vec3 color = points.colors->values[i];
    const double from_middle = std::max(std::abs(p.x - 5), std::abs(p.y - 5));
    const bool behind = p.z < 1 && from_middle < 1.15;  // the board's shadow reaches 1.25
    EXPECT_TRUE(!behind || color == glm::u16vec3(231)) << p.x << " " << p.y;
    if (p.z > 1 || from_middle < 1.4) continue;
    const Texel ideal = ground_at(p.x, p.y);
    for (int c = 0; c < 3; ++c) error += std::pow(int{color[c]} - int{ideal[static_cast<size_t>(c)]}, 2);
    compared += 3;
  }
  EXPECT_GT(10 * std::log10(255.0 * 255.0 * static_cast<double>(compared) / error), 40);
  EXPECT_GT(report.hidden, 1500U);
  EXPECT_EQ(report.outside, 0U);
}

TEST(PaintFromCameras, DistortionMovesPixels) {
  const MeshFolder folder;
  const PhotoCamera camera = cameras_in(folder, R"(, "radial": [0.1, 0.2, 0.3], "tangential": [0.01, 0.02]})")[0];
  const auto seen = camera.project({15, 0, 0});  // x = 0.5, y = 0.25, r^2 = 0.3125
  ASSERT_TRUE(seen);
  const double factor = 1 + 0.1 * 0.3125 + 0.2 * 0.09765625 + 0.3 * 0.030517578125;
  EXPECT_NEAR(seen->pixel.x, 100 + 300 * (0.5 * factor + 0.02 * 0.125 + 0.02 * (0.3125 + 0.5)), 1e-9);
  EXPECT_NEAR(seen->pixel.y, 100 + 300 * (0.25 * factor + 0.01 * (0.3125 + 0.125) + 0.04 * 0.125), 1e-9);
  EXPECT_FALSE(camera.project({5, 5, 30}));
}

TEST(PaintFromCameras, DamagedBundlesAreErrors) {
  const std::filesystem::path path = "bundle.json";
  EXPECT_FALSE(parse_cameras("", path));
  EXPECT_FALSE(parse_cameras(R"({"cameras": []})", path));
  EXPECT_FALSE(parse_cameras(R"({"cameras": [{"image": "a.png"}]})", path));
  EXPECT_FALSE(parse_cameras(R"({"cameras": [7]})", path));
  const std::string wrong = R"({"cameras": [{"image": "../a.png", "position": [0, 0, 0], "focal": [1, 1],
      "rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "principal_point": [1, 1]}]})";
  EXPECT_FALSE(parse_cameras(wrong, path));
}

}  // namespace
}  // namespace surfcast::colorize
