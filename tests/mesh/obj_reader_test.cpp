#include <algorithm>

#include <gtest/gtest.h>

#include "mesh/mesh_files.h"

namespace surfcast::mesh {
namespace {

TEST(ObjReader, VCountsFromTheLowerEdgeAndIndicesMayBeRelative) {
  const MeshFolder folder;
  const auto file = folder.write("a.obj",
                                 "v 500000.125 0 0\nv 500001 0 0\nv 500001 1 0\nvt 0.25 0.125\nvt 1 0\nvt 1 1\n"
                                 "f -3/-3 -2/-2 -1/-1\n");
  const Result<Mesh> mesh = read(file);
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->patches.size(), 1U);
  const Patch& patch = mesh->patches[0];
  const Corner& corner = (*patch.triangles)[0][0];
  EXPECT_EQ(patch.vertices->positions[corner.position], glm::dvec3(500000.125, 0, 0));
  EXPECT_EQ(patch.vertices->uvs[corner.uv], glm::dvec2(0.25, 0.875));
  EXPECT_EQ(corner.normal, kNone);
  EXPECT_TRUE(patch.vertices->colors.empty());
}

TEST(ObjReader, PolygonsBecomeTriangles) {
  const MeshFolder folder;
  const auto file = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 1.5 0\nv 0 1 0\nf 1 2 3 4 5\n");
  const Result<Mesh> mesh = read(file);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles(), 3U);
}

TEST(ObjReader, TheDiffuseColourCountsOnlyWithoutATexture) {
  const MeshFolder folder;
  folder.write("m.mtl",
               "newmtl plain\nKd 1 0.5 0\nd 0.25\nnewmtl textured\nKd 0.6 0.6 0.6\nmap_Kd -clamp on a b.tga\n");
  const auto file = folder.write("a.obj",
                                 "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl plain\nf 1 2 3\nusemtl textured\n"
                                 "f 3 2 1\n");
  const Result<Mesh> mesh = read(file);
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->patches.size(), 2U);
  const Material& plain = mesh->materials[mesh->patches[0].material];
  EXPECT_NEAR(plain.color.g, 0.2140, 1e-3);  // linear light of sRGB 0.5
  EXPECT_EQ(plain.color.a, 0.25F);
  EXPECT_EQ(plain.alpha, AlphaMode::kBlend);
  const Material& textured = mesh->materials[mesh->patches[1].material];
  EXPECT_EQ(textured.color, glm::vec4(1));
  ASSERT_TRUE(textured.image);
  EXPECT_EQ(mesh->images[*textured.image].file.filename(), "a b.tga");
  EXPECT_EQ(textured.wrap[0], Wrap::kClamp);
}

TEST(ObjReader, VertexColoursAreSrgb) {
  const MeshFolder folder;
  const auto file = folder.write("a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 1 1 0 1 0.5 0\nf 1 2 3\n");
  const Result<Mesh> mesh = read(file);
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->patches[0].vertices->colors.size(), 3U);
  EXPECT_NEAR(mesh->patches[0].vertices->colors[0].g, 0.2140, 1e-3);
}

TEST(ObjReader, MaterialsAndImagesStayInTheFolder) {
  const MeshFolder folder;
  folder.write("secret.mtl", "newmtl m\nKd 1 0 0\n");
  folder.write("model/m.mtl", "newmtl m\nmap_Kd ../secret.tga\n");
  const auto file =
      folder.write("model/a.obj", "mtllib ../secret.mtl m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\n");
  const Result<Mesh> mesh = read(file);
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->images.size(), 1U);
  EXPECT_TRUE(mesh->images[0].unavailable);
  EXPECT_TRUE(mesh->images[0].file.empty());
}

TEST(ObjReader, AnIndexBeyondTheListIsAnError) {
  const MeshFolder folder;
  for (const char* face : {"f 1 2 9", "f 1/7 2/1 3/1", "f 1//4 2//1 3//1"}) {
    const auto file = folder.write("a.obj", std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\n") + face + "\n");
    const Result<Mesh> mesh = read(file);
    ASSERT_FALSE(mesh) << face;
    EXPECT_TRUE(mesh.error().message.starts_with(file.string())) << mesh.error().message;
  }
}

TEST(ObjReader, APolygonOfVeryManyCornersIsRefused) {
  const MeshFolder folder;
  std::string content = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf";
  for (int i = 0; i < 1000; ++i) content += " 1 2 3";
  const Result<Mesh> mesh = read(folder.write("a.obj", content + "\n"));
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().kind, ErrorKind::kLimit);
}

TEST(ObjReader, EveryTruncatedFileIsReadOrRefused) {
  const MeshFolder folder;
  const std::string whole =
      "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1\n";
  for (size_t size = 1; size < whole.size(); ++size) {
    const Result<Mesh> mesh = read(folder.write("a.obj", whole.substr(0, size)));
    EXPECT_EQ(mesh ? mesh->triangles() : 1U, 1U);
  }
}

}  // namespace
}  // namespace surfcast::mesh
