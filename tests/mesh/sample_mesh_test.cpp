#include "mesh/sample_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "mesh/mesh_files.h"
#include "mesh/texture.h"

namespace surfcast::mesh {
namespace {

Texel number(int x, int y) {
  return {static_cast<uint8_t>(x * 16), static_cast<uint8_t>(y * 16), static_cast<uint8_t>((x + y) % 2 * 255), 255};
}

TEST(SampleMesh, EveryTexelBecomesOneSurfelWithItsColourAtItsCentre) {
  const MeshFolder folder;
  folder.write("t.tga", targa(16, 16, number));
  write_square(folder, "t.tga", 4);
  const Sampled sampled = sample(folder.path() / "square.obj");
  ASSERT_EQ(sampled.surfels.size(), 256U);
  EXPECT_NEAR(sampled.report.texels, 256, 1e-9);
  for (const MeshSurfel& surfel : sampled.surfels) {
    const double x = surfel.position.x * 4 - 0.5;
    const double y = 15.5 - surfel.position.y * 4;
    EXPECT_NEAR(x, std::round(x), 1e-9);
    EXPECT_NEAR(y, std::round(y), 1e-9);
    const Texel texel = number(static_cast<int>(std::round(x)), static_cast<int>(std::round(y)));
    EXPECT_EQ(surfel.color, glm::u8vec3(texel[0], texel[1], texel[2]));
    EXPECT_EQ(surfel.normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(surfel.alpha, 255);
  }
}

TEST(SampleMesh, RadiiFollowTheAreaOfATexelAndAreSmallerAtOpenBorders) {
  const MeshFolder folder;
  folder.write("t.tga", targa(16, 16, number));
  write_square(folder, "t.tga", 4);
  for (const MeshSurfel& surfel : sample(folder.path() / "square.obj").surfels) {
    const glm::dvec3 from_border = glm::min(surfel.position, 4.0 - surfel.position);
    const bool border = std::min(from_border.x, from_border.y) < 0.2;
    EXPECT_NEAR(surfel.radius, 0.25 * (border ? std::max(0.5 + 0.4 * 1.115, 0.85 * 1.115) : 1.115), 1e-6);
  }
}

TEST(SampleMesh, FewerSurfelsHaveTheMeanLightOfTheirCells) {
  const MeshFolder folder;
  folder.write("t.tga", targa(16, 16, [](int x, int) { return Texel{static_cast<uint8_t>(x % 2 * 255), 0, 0, 255}; }));
  write_square(folder, "t.tga", 16);
  const Sampled sampled = sample(folder.path() / "square.obj", {2.0});
  ASSERT_EQ(sampled.surfels.size(), 64U);
  for (const MeshSurfel& surfel : sampled.surfels) EXPECT_EQ(surfel.color, glm::u8vec3(188, 0, 0));  // half the light
}

TEST(SampleMesh, MoreSurfelsThanTexelsFollowTheBilinearTexture) {
  const MeshFolder folder;
  folder.write("t.tga", targa(4, 4, [](int x, int) {
                 return Texel{static_cast<uint8_t>(x < 2 ? 0 : 255), 0, 0, 255};
               }));
  write_square(folder, "t.tga", 4);
  const Sampled sampled = sample(folder.path() / "square.obj", {0.5});
  ASSERT_EQ(sampled.surfels.size(), 64U);
  std::map<int, int> reds;
  for (const MeshSurfel& surfel : sampled.surfels) reds[static_cast<int>(surfel.position.x * 4)] = surfel.color.r;
  EXPECT_EQ(reds[3], 0);
  EXPECT_EQ(reds[7], 137);  // a quarter of the light
  EXPECT_EQ(reds[9], 225);  // three quarters
  EXPECT_EQ(reds[13], 255);
}

TEST(SampleMesh, AFewTrianglesWithoutTextureAreNoMillionSurfels) {
  const MeshFolder folder;
  folder.write("one.obj", "v 0 0 0\nv 3 0 0\nv 0 3 0\nf 1 2 3\n");
  const size_t one = sample(folder.path() / "one.obj").surfels.size();
  EXPECT_NEAR(static_cast<double>(one), 131072, 1000);
}

TEST(SampleMesh, ThereAreNoMoreSurfelsThanAskedFor) {
  const MeshFolder folder;
  folder.write("t.tga", targa(16, 16, number));
  write_square(folder, "t.tga", 4);
  EXPECT_EQ(sample(folder.path() / "square.obj", {std::nullopt, 100}).surfels.size(), 64U);
}

/// Two charts of 7 texels side by side, a magenta one between them.
std::string two_charts() {
  return targa(16, 8, [](int x, int) {
    if (x < 7) return Texel{0, 200, 0, 255};
    return x < 9 ? Texel{255, 0, 255, 255} : Texel{0, 0, 200, 255};
  });
}

void write_charts(const MeshFolder& folder) {
  folder.write("t.tga", two_charts());
  folder.write("m.mtl", "newmtl m\nmap_Kd t.tga\n");
  folder.write(
      "charts.obj",
      "mtllib m.mtl\nv 0 0 0\nv 7 0 0\nv 7 8 0\nv 0 8 0\nv 14 0 0\nv 14 8 0\nvt 0 0\nvt 0.4375 0\nvt 0.4375 1\n"
      "vt 0 1\nvt 0.5625 0\nvt 1 0\nvt 1 1\nvt 0.5625 1\nusemtl m\nf 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n");
}

TEST(SampleMesh, ColoursNeverComeFromOutsideAChart) {
  const MeshFolder folder;
  write_charts(folder);
  for (const double spacing : {0.25, 0.5, 1.0, 2.0, 4.0}) {
    const Sampled sampled = sample(folder.path() / "charts.obj", {spacing});
    EXPECT_GE(sampled.surfels.size(), 4U);
    for (const MeshSurfel& surfel : sampled.surfels) {
      const glm::u8vec3 own = surfel.position.x < 7 ? glm::u8vec3(0, 200, 0) : glm::u8vec3(0, 0, 200);
      EXPECT_EQ(surfel.color, own) << spacing << " at " << surfel.position.x;
    }
  }
}

TEST(SampleMesh, StretchedTexelsAreCut) {
  const MeshFolder folder;
  folder.write("t.tga", targa(4, 4, number));
  folder.write("m.mtl", "newmtl m\nmap_Kd t.tga\n");
  folder.write("a.obj",
               "mtllib m.mtl\nv 0 0 0\nv 16 0 0\nv 16 4 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n"
               "f 1/1 2/2 3/3 4/4\n");
  const Sampled sampled = sample(folder.path() / "a.obj");
  EXPECT_EQ(sampled.surfels.size(), 64U);  // four for each texel of 4 by 1
  const auto widest = std::max_element(sampled.surfels.begin(), sampled.surfels.end(),
                                       [](const MeshSurfel& a, const MeshSurfel& b) { return a.radius < b.radius; });
  EXPECT_NEAR(widest->radius, 1.115, 1e-6);
}

TEST(SampleMesh, SurfacesWithoutTextureAreCoveredEvenly) {
  const MeshFolder folder;
  const auto file = folder.write("a.obj", "v 0 0 0\nv 3 0 1\nv 3 3 2\nv 0 3 1\nf 1 2 3\nf 1 3 4\n");
  const Sampled sampled = sample(file, {0.02});
  const double area = 9 * std::sqrt(1 + 2.0 / 9);  // of the parallelogram with the steps (3, 0, 1) and (0, 3, 1)
  EXPECT_NEAR(static_cast<double>(sampled.surfels.size()) / (area / 0.0004), 0.95, 0.07);
  for (const MeshSurfel& surfel : sampled.surfels) {
    EXPECT_EQ(surfel.color, glm::u8vec3(255));
    EXPECT_NEAR(glm::length(glm::dvec3(surfel.normal)), 1, 1e-6);
    EXPECT_NEAR(surfel.position.x / 3 + surfel.position.y / 3, surfel.position.z, 1e-9);
  }
}

TEST(SampleMesh, ASolidHasAnOutsideWhateverTheDirectionOfItsTriangles) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const MeshFolder folder;
  for (const char* faces : {"f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", "f 2 3 1\nf 4 2 1\nf 4 3 2\nf 4 1 3\n"}) {
    const Sampled sampled = sample(folder.write("a.obj", corners + faces), {0.05});
    EXPECT_FALSE(sampled.report.two_sided);
    for (const MeshSurfel& surfel : sampled.surfels) {
      EXPECT_GT(glm::dot(surfel.position - glm::dvec3(0.2), glm::dvec3(surfel.normal)), 0);
    }
  }
  EXPECT_TRUE(sample(folder.write("b.obj", corners + "f 1 3 2\nf 1 2 4\n"), {0.05}).report.two_sided);
}

TEST(SampleMesh, AMissingImageIsANote) {
  const MeshFolder folder;
  folder.write("t.tga", targa(4, 4, number));
  folder.write("m.mtl", "newmtl a\nmap_Kd t.tga\nnewmtl b\nKd 1 0 0\nmap_Kd none.tga\n");
  const std::string vertices = "mtllib m.mtl\nv 0 0 0\nv 4 0 0\nv 4 4 0\nvt 0 0\nvt 1 0\nvt 1 1\n";
  const Sampled sampled =
      sample(folder.write("a.obj", vertices + "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 3/3 2/2 1/1\n"));
  EXPECT_EQ(sampled.report.images, 2U);
  EXPECT_EQ(sampled.report.images_missing, 1U);
  ASSERT_EQ(sampled.report.notes.size(), 1U);
  EXPECT_NE(sampled.report.notes[0].find("none.tga"), std::string::npos);
}

TEST(SampleMesh, AMeshWithoutAnyOfItsImagesHasTheColoursOfItsMaterials) {
  const MeshFolder folder;
  folder.write("m.mtl", "newmtl b\nKd 1 0 0\nmap_Kd none.tga\n");
  const Sampled sampled = sample(folder.write(
      "b.obj", "mtllib m.mtl\nv 0 0 0\nv 4 0 0\nv 4 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl b\nf 1/1 2/2 3/3\n"));
  EXPECT_EQ(sampled.report.images_missing, 1U);
  ASSERT_EQ(sampled.report.notes.size(), 1U);
  EXPECT_NE(sampled.report.notes[0].find("none.tga"), std::string::npos);
  ASSERT_FALSE(sampled.surfels.empty());
}

TEST(SampleMesh, ATexturedPlyWithoutItsImageIsDrawnWithoutIt) {
  const MeshFolder folder;
  const Sampled sampled = sample(folder.write("a.ply", R"(ply
format ascii 1.0
comment TextureFile none.png
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
property list uchar float texcoord
end_header
0 0 0
4 0 0
4 4 0
3 0 1 2 6 0 0 1 0 1 1
)"));
  EXPECT_EQ(sampled.report.images_missing, 1U);
  ASSERT_EQ(sampled.report.notes.size(), 1U);
  EXPECT_NE(sampled.report.notes[0].find("none.png"), std::string::npos);
  EXPECT_FALSE(sampled.surfels.empty());
}

TEST(SampleMesh, ATextureBeyondTheMemoryIsMissing) {
  const MeshFolder folder;
  folder.write("t.tga", targa(256, 256, [](int, int) { return Texel{1, 2, 3, 255}; }));
  write_square(folder, "t.tga", 4);
  const Result<Mesh> mesh = read(folder.path() / "square.obj");
  ASSERT_TRUE(mesh);
  const auto ignore = [](std::span<const MeshSurfel>) { return Status(); };
  EXPECT_FALSE(sample_mesh(*mesh, {}, scan::DecodingLimit{100000}, ignore));
}

TEST(SampleMesh, TextureCoordinatesBeyondTheImageFollowTheWrapMode) {
  EXPECT_EQ(wrapped(-1, 4, Wrap::kRepeat), 3);
  EXPECT_EQ(wrapped(9, 4, Wrap::kRepeat), 1);
  EXPECT_EQ(wrapped(-1, 4, Wrap::kMirror), 0);
  EXPECT_EQ(wrapped(4, 4, Wrap::kMirror), 3);
  EXPECT_EQ(wrapped(9, 4, Wrap::kMirror), 1);
  EXPECT_EQ(wrapped(-7, 4, Wrap::kClamp), 0);
  EXPECT_EQ(wrapped(7, 4, Wrap::kClamp), 3);
}

TEST(SampleMesh, TextureCoordinatesWithoutAreaTakeTheirColourFromTheTexel) {
  const MeshFolder folder;
  folder.write("t.tga", targa(16, 16, number));
  folder.write("m.mtl", "newmtl m\nmap_Kd t.tga\n");
  const Sampled sampled = sample(
      folder.write("a.obj", "mtllib m.mtl\nv 0 0 0\nv 4 0 0\nv 4 4 0\nvt 0.21875 0.78125\nusemtl m\nf 1/1 2/1 3/1\n"),
      {0.1});
  EXPECT_NEAR(static_cast<double>(sampled.surfels.size()), 800, 50);
  for (const MeshSurfel& surfel : sampled.surfels) EXPECT_EQ(surfel.color, glm::u8vec3(48, 48, 0));
}

TEST(SampleMesh, SurfelsDoNotDependOnTheNumberOfThreads) {
  const MeshFolder folder;
  folder.write("t.tga", targa(256, 256, [](int x, int y) {
                 return Texel{static_cast<uint8_t>(x), static_cast<uint8_t>(y), static_cast<uint8_t>(x * y), 255};
               }));
  write_square(folder, "t.tga", 4);
  const Sampled all = sample(folder.path() / "square.obj", {0.005});
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const Sampled single = sample(folder.path() / "square.obj", {0.005});
  ASSERT_EQ(all.surfels.size(), single.surfels.size());
  for (size_t i = 0; i < all.surfels.size(); ++i) {
    EXPECT_EQ(all.surfels[i].position, single.surfels[i].position);
    EXPECT_EQ(all.surfels[i].color, single.surfels[i].color);
  }
}

}  // namespace
}  // namespace surfcast::mesh
