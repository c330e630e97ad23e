#include "colorize/paint_from_above.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "colorize/xyz_line.h"
#include "mesh/mesh_files.h"

namespace surfcast::colorize {
namespace {

using mesh::MeshFolder;
using mesh::Texel;

/// A picture of smooth colours, 100 x 100 pixels of 0.2 units from (0, 0) to (20, 20).
Texel photo_at(double x, double y) {
  const auto level = [](double wave) { return static_cast<uint8_t>(std::lround(128 + 100 * std::sin(wave))); };
  return {level(x * 0.9), level(y * 0.8), level((x + y) * 0.4), 255};
}

GeoPhoto write_photo(const MeshFolder& folder) {
  folder.write("photo.tga",
               mesh::targa(100, 100, [](int i, int j) { return photo_at(0.2 * i + 0.1, 20 - 0.2 * j - 0.1); }));
  folder.write("photo.taw", "0.2\n0\n0\n-0.2\n0.1\n19.9\n");
  return read_geo_photo(folder.path() / "photo.tga", {}).value();
}

double terrain(double x, double y) {
  return std::sin(x * 0.4) + 0.5 * std::cos(y * 0.7);
}

scan::ScanPoints read_all(const scan::ScanStream& stream) {
  return stream.read(0).value();
}

TEST(PaintFromAbove, TerrainIsReadBackAndTreesDoNotPaintTheGroundBelowThem) {
  const MeshFolder folder;
  const GeoPhoto photo = write_photo(folder);
  std::string rows;
  for (int j = 0; j < 100; ++j) {
    for (int i = 0; i < 100; ++i) {
      const double x = 0.2 * i + 0.13;
      const double y = 0.2 * j + 0.07;
      rows += testing::xyz_line(x, y, terrain(x, y));
      const bool tree = std::hypot(x - 8, y - 12) < 2;
      if (tree) rows += testing::xyz_line(x + 0.05, y + 0.05, 6);
    }
  }
  const auto file = folder.write("scan.xyz", rows);
  PaintReport report;
  const Result<scan::ScanStream> painted =
      paint_from_above(scan::ScanStream::open(file).value(), file, photo, {}, {}, report);
  ASSERT_TRUE(painted) << painted.error().message;
  const scan::ScanPoints points = read_all(*painted);
  double error = 0;
  uint64_t compared = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3& p = points.positions[i];
    const glm::u16vec3 color = points.colors->values[i];
    const double from_tree = std::hypot(p.x - 8, p.y - 12);
    const bool covered = p.z < 3 && from_tree < 1.7;
    EXPECT_TRUE(!covered || color == glm::u16vec3(231)) << p.x << " " << p.y;
    if (p.z < 3 && from_tree < 2.5) continue;
    const Texel ideal = photo_at(p.x, p.y);
    for (int c = 0; c < 3; ++c) error += std::pow(int{color[c]} - int{ideal[static_cast<size_t>(c)]}, 2);
    compared += 3;
  }
  EXPECT_GT(10 * std::log10(255.0 * 255.0 * static_cast<double>(compared) / error), 40);
  EXPECT_GT(report.hidden, 200U);
  EXPECT_EQ(report.outside, 0U);
  EXPECT_EQ(report.painted + report.hidden, points.size());
}

TEST(PaintFromAbove, PointsBesideThePictureKeepTheirColours) {
  const MeshFolder folder;
  const GeoPhoto photo = write_photo(folder);
  const auto file = folder.write("scan.txt", "x y z red green blue\n10 10 0 1 2 3\n50 10 0 40 50 60\n10 11 0 1 2 3\n");
  PaintReport report;
  const Result<scan::ScanStream> painted =
      paint_from_above(scan::ScanStream::open(file).value(), file, photo, {}, {}, report);
  ASSERT_TRUE(painted) << painted.error().message;
  const scan::ScanPoints points = read_all(*painted);
  EXPECT_EQ(points.colors->values[1], glm::u16vec3(40, 50, 60));
  EXPECT_NE(points.colors->values[0], glm::u16vec3(1, 2, 3));
  EXPECT_EQ(report.outside, 1U);
}

TEST(PaintFromAbove, APictureOfAnotherPlaceIsAnError) {
  const MeshFolder folder;
  const GeoPhoto photo = write_photo(folder);
  const auto file = folder.write("scan.xyz", "500 500 0\n501 500 0\n500 501 0\n");
  PaintReport report;
  EXPECT_FALSE(paint_from_above(scan::ScanStream::open(file).value(), file, photo, {}, {}, report));
}

}  // namespace
}  // namespace surfcast::colorize
