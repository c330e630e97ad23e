// Opacities of OBJ materials (d, map_d, alpha of map_Kd), with images of different resolutions.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "mesh/mesh_files.h"

namespace surfcast::mesh {
namespace {

Texel grey(int level) {
  const auto code = static_cast<uint8_t>(level);
  return {code, code, code, 255};
}

/// A square of 4 x 4 with these lines of a material, sampled.
Sampled sample_square(const MeshFolder& folder, const std::string& material, const SampleOptions& options = {}) {
  write_square(folder, "unused.tga", 4);
  folder.write("square.mtl", "newmtl m\n" + material);
  return sample(folder.path() / "square.obj", options);
}

/// The surfel nearest to a place on the square.
const MeshSurfel& surfel_near(const Sampled& sampled, double x, double y) {
  return *std::min_element(sampled.surfels.begin(), sampled.surfels.end(), [&](const auto& a, const auto& b) {
    return std::hypot(a.position.x - x, a.position.y - y) < std::hypot(b.position.x - x, b.position.y - y);
  });
}

TEST(OpacityMap, AFinerMapMakesTheSurfelsAndKeepsItsDetail) {
  const MeshFolder folder;
  folder.write("c.tga", targa(2, 2, [](int x, int) { return x == 0 ? Texel{200, 0, 0, 255} : Texel{0, 0, 200, 255}; }));
  folder.write("d.tga", targa(8, 8, [](int x, int y) { return grey((x + y) % 2 != 0 ? 255 : 51); }));
  const Sampled sampled = sample_square(folder, "map_Kd -clamp on c.tga\nmap_d d.tga\n");
  ASSERT_EQ(sampled.surfels.size(), 64U);
  EXPECT_TRUE(sampled.report.blended);
  EXPECT_EQ(sampled.report.images, 2U);
  for (const MeshSurfel& surfel : sampled.surfels) {
    const int x = static_cast<int>(surfel.position.x * 2);
    const int y = 7 - static_cast<int>(surfel.position.y * 2);
    EXPECT_EQ(surfel.alpha, (x + y) % 2 != 0 ? 255 : 51) << x << ", " << y;
  }
  EXPECT_EQ(surfel_near(sampled, 0.25, 2).color, glm::u8vec3(200, 0, 0));
  EXPECT_EQ(surfel_near(sampled, 3.75, 2).color, glm::u8vec3(0, 0, 200));
}

TEST(OpacityMap, ACoarserMapIsLinearBetweenItsTexels) {
  const MeshFolder folder;
  folder.write("c.tga", targa(16, 16, [](int x, int y) { return grey(16 * ((x + y) % 2)); }));
  folder.write("d.tga", targa(2, 1, [](int x, int) { return grey(x == 0 ? 40 : 240); }));
  const Sampled sampled = sample_square(folder, "map_Kd -clamp on c.tga\nmap_d d.tga\n");
  ASSERT_EQ(sampled.surfels.size(), 256U);
  EXPECT_EQ(surfel_near(sampled, 0.875, 2).alpha, 40);  // before the first centre
  EXPECT_NEAR(surfel_near(sampled, 1.875, 2).alpha, 127.5, 1);
  EXPECT_NEAR(surfel_near(sampled, 2.125, 2).alpha, 152.5, 1);
  EXPECT_EQ(surfel_near(sampled, 3.125, 2).alpha, 240);
}

TEST(OpacityMap, OpacitiesOfTheMapOfColoursAndOfTheMaterialMultiply) {
  const MeshFolder folder;
  folder.write("c.tga", targa(8, 4, [](int, int) { return Texel{10, 20, 30, 128}; }));
  folder.write("d.tga", targa(4, 8, [](int, int) { return grey(128); }));
  for (const char* factor : {"d 0.5\n", "Tr 0.5\n"}) {
    const Sampled sampled = sample_square(folder, std::string(factor) + "map_Kd c.tga\nmap_d d.tga\n");
    ASSERT_EQ(sampled.surfels.size(), 64U);
    for (const MeshSurfel& surfel : sampled.surfels) {
      EXPECT_NEAR(surfel.alpha, 255 * 0.5 * (128 / 255.0) * (128 / 255.0), 0.51);
      EXPECT_EQ(surfel.color, glm::u8vec3(10, 20, 30));
    }
  }
}

TEST(OpacityMap, TheAlphaOfAPictureThatIsBothCountsOnce) {
  const MeshFolder folder;
  folder.write("c.tga", targa(4, 4, [](int x, int) {
                 return Texel{10, 20, 30, static_cast<uint8_t>(x == 0 ? 0 : 100)};
               }));
  const Sampled sampled = sample_square(folder, "map_Kd c.tga\nmap_d c.tga\n");
  EXPECT_EQ(sampled.surfels.size(), 12U);
  EXPECT_EQ(sampled.report.masked, 4U) << "what is not there makes no surfel";
  EXPECT_EQ(sampled.report.images, 1U);
  for (const MeshSurfel& surfel : sampled.surfels) EXPECT_EQ(surfel.alpha, 100);
}

TEST(OpacityMap, AChannelIsAlphaOrLuminanceUnlessStated) {
  const MeshFolder folder;
  folder.write("alpha.tga", targa(4, 4, [](int, int) { return Texel{200, 100, 50, 77}; }));
  folder.write("color.tga", targa(4, 4, [](int, int) { return Texel{200, 100, 50, 255}; }));
  const auto alpha_of = [&](const std::string& map) {
    return int{sample_square(folder, "Kd 1 0 0\nmap_d " + map + "\n").surfels.at(0).alpha};
  };
  EXPECT_EQ(alpha_of("alpha.tga"), 77);
  EXPECT_EQ(alpha_of("color.tga"), 118);  // 0.2126 R + 0.7152 G + 0.0722 B
  EXPECT_EQ(alpha_of("-imfchan r alpha.tga"), 200);
  EXPECT_EQ(alpha_of("-imfchan g alpha.tga"), 100);
  EXPECT_EQ(alpha_of("-imfchan b alpha.tga"), 50);
  EXPECT_EQ(alpha_of("-imfchan l alpha.tga"), 118);
}

TEST(OpacityMap, WithoutAMapOfColoursItsTexelsHaveTheMaterialsColour) {
  const MeshFolder folder;
  folder.write("d.tga", targa(8, 8, [](int, int) { return grey(100); }));
  const Sampled sampled = sample_square(folder, "Kd 1 0.5 0\nmap_d d.tga\n");
  ASSERT_EQ(sampled.surfels.size(), 64U);
  for (const MeshSurfel& surfel : sampled.surfels) {
    EXPECT_EQ(surfel.color, glm::u8vec3(255, 128, 0));
    EXPECT_EQ(surfel.alpha, 100);
  }
}

TEST(OpacityMap, FewerSurfelsHaveTheMeanOfWhatIsSeen) {
  const MeshFolder folder;
  folder.write("c.tga", targa(16, 16, [](int x, int) {
                 return x % 2 != 0 ? Texel{0, 255, 0, 255} : Texel{0, 0, 0, 255};
               }));
  folder.write("d.tga", targa(16, 16, [](int x, int) { return grey(x % 2 != 0 ? 255 : 0); }));
  const Sampled sampled = sample_square(folder, "map_Kd c.tga\nmap_d d.tga\n", {0.5});
  ASSERT_EQ(sampled.surfels.size(), 64U);
  for (const MeshSurfel& surfel : sampled.surfels) {
    EXPECT_EQ(surfel.color, glm::u8vec3(0, 255, 0)) << "what is not there has no colour";
    EXPECT_NEAR(surfel.alpha, 128, 1);
  }
}

TEST(OpacityMap, ColoursOfACoarserPictureStayWithinTheirChart) {
  const MeshFolder folder;
  const auto chart = [](int x, int width) {
    return x < width / 2 - width / 16 ? 0 : x < width / 2 + width / 16 ? 1 : 2;
  };
  folder.write("c.tga", targa(16, 8, [&](int x, int) {
                 constexpr std::array<Texel, 3> kColors{{{0, 200, 0, 255}, {255, 0, 255, 255}, {0, 0, 200, 255}}};
                 return kColors[static_cast<size_t>(chart(x, 16))];
               }));
  folder.write("d.tga", targa(64, 32, [&](int x, int) { return grey(chart(x, 64) == 1 ? 0 : 255); }));
  folder.write("m.mtl", "newmtl m\nmap_Kd c.tga\nmap_d d.tga\n");
  const auto file = folder.write(
      "charts.obj",
      "mtllib m.mtl\nv 0 0 0\nv 7 0 0\nv 7 8 0\nv 0 8 0\nv 14 0 0\nv 14 8 0\nvt 0 0\nvt 0.4375 0\nvt 0.4375 1\n"
      "vt 0 1\nvt 0.5625 0\nvt 1 0\nvt 1 1\nvt 0.5625 1\nusemtl m\nf 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n");
  const Sampled sampled = sample(file);
  EXPECT_EQ(sampled.surfels.size(), 2U * 28U * 32U);
  for (const MeshSurfel& surfel : sampled.surfels) {
    EXPECT_EQ(surfel.color, surfel.position.x < 7 ? glm::u8vec3(0, 200, 0) : glm::u8vec3(0, 0, 200));
    EXPECT_EQ(surfel.alpha, 255) << surfel.position.x;
  }
}

TEST(OpacityMap, AMissingMapIsANote) {
  const MeshFolder folder;
  folder.write("c.tga", targa(4, 4, [](int, int) { return Texel{10, 20, 30, 255}; }));
  const Sampled sampled = sample_square(folder, "d 0.5\nmap_Kd c.tga\nmap_d none.tga\n");
  EXPECT_EQ(sampled.surfels.size(), 16U);
  EXPECT_EQ(sampled.report.images_missing, 1U);
  ASSERT_EQ(sampled.report.notes.size(), 1U);
  EXPECT_NE(sampled.report.notes[0].find("none.tga"), std::string::npos);
  for (const MeshSurfel& surfel : sampled.surfels) EXPECT_EQ(surfel.alpha, 128);
}

TEST(OpacityMap, ImagesThatOnlyFitAloneDoNotFitTogether) {
  const MeshFolder folder;
  const auto any = [](int, int) { return Texel{1, 2, 3, 128}; };
  folder.write("c.tga", targa(64, 64, any));
  folder.write("d.tga", targa(64, 64, any));
  write_square(folder, "c.tga", 4);
  folder.write("square.mtl", "newmtl m\nmap_Kd c.tga\nmap_d d.tga\n");
  const Result<Mesh> mesh = read(folder.path() / "square.obj");
  ASSERT_TRUE(mesh);
  const auto ignore = [](std::span<const MeshSurfel>) { return Status(); };
  const auto missing_with = [&](uint64_t bytes) {
    const Result<MeshReport> report = sample_mesh(*mesh, {}, scan::DecodingLimit{bytes}, ignore);
    return report ? report->images_missing : uint64_t{99};
  };
  EXPECT_EQ(missing_with(8 * 64 * 64), 1U);
  EXPECT_EQ(missing_with(3 * 8 * 64 * 64), 0U);
}

}  // namespace
}  // namespace surfcast::mesh
