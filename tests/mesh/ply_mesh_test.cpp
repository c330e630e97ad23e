#include <gtest/gtest.h>

#include "mesh/mesh_files.h"

namespace surfcast::mesh {
namespace {

const std::string kHead =
    "ply\nformat ascii 1.0\ncomment TextureFile first.tga\ncomment TextureFile the second.tga\n"
    "element vertex 3\nproperty double x\nproperty double y\nproperty double z\n";

TEST(PlyMesh, TextureCoordinatesOfCornersAndNumbersOfTexturesAreRead) {
  const MeshFolder folder;
  const auto file = folder.write(
      "a.ply", kHead +
                   "element face 2\nproperty list uchar int vertex_index\nproperty list uchar float texcoord\n"
                   "property int texnumber\nend_header\n500000.25 0 0\n1 0 0\n0 1 0\n"
                   "3 0 1 2 6 0 0 0.5 0 0 0.25 1\n3 2 1 0 6 0 0 1 0 0 1 0\n");
  const Result<Mesh> mesh = read(file);
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->patches.size(), 2U);
  const Patch& second = mesh->patches[1];
  EXPECT_EQ(mesh->images[*mesh->materials[second.material].image].file.filename(), "the second.tga");
  const Corner& corner = (*second.triangles)[0][2];
  EXPECT_EQ(second.vertices->uvs[corner.uv], glm::dvec2(0, 0.75));
  EXPECT_EQ(mesh->materials[second.material].wrap[0], Wrap::kClamp);
  EXPECT_EQ(second.vertices->positions[0].x, 500000.25);
}

TEST(PlyMesh, TextureCoordinatesOfVerticesAreRead) {
  const MeshFolder folder;
  const auto file =
      folder.write("a.ply", kHead +
                                "property float texture_u\nproperty float texture_v\nelement face 1\n"
                                "property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n"
                                "0 1 0 0 1\n3 0 1 2\n");
  const Result<Mesh> mesh = read(file);
  ASSERT_TRUE(mesh) << mesh.error().message;
  const Patch& patch = mesh->patches[0];
  EXPECT_EQ(patch.vertices->uvs[(*patch.triangles)[0][2].uv], glm::dvec2(0, 0));
}

TEST(PlyMesh, AlphaBelowOneIsOpacity) {
  const MeshFolder folder;
  const auto file =
      folder.write("a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                   "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                   "0 0 0 255 0 0 51\n1 0 0 255 0 0 51\n0 1 0 255 0 0 51\n3 0 1 2\n");
  const Result<Mesh> mesh = read(file);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->materials[0].alpha, AlphaMode::kBlend);
  const Sampled sampled = sample(*mesh, {0.05});
  EXPECT_TRUE(sampled.report.blended);
  ASSERT_FALSE(sampled.surfels.empty());
  EXPECT_EQ(sampled.surfels[0].alpha, 51);
  EXPECT_EQ(sampled.surfels[0].color, glm::u8vec3(255, 0, 0));
}

TEST(PlyMesh, DamageIsAnError) {
  const MeshFolder folder;
  const std::string head = kHead + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_FALSE(read(folder.write("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")));
  EXPECT_FALSE(read(folder.write("b.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n")));
  EXPECT_FALSE(read(folder.write("c.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n")));
  EXPECT_FALSE(read(folder.write("d.ply", head + "0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n")));
  EXPECT_FALSE(read(folder.write("e.ply", head + "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n")));
}

}  // namespace
}  // namespace surfcast::mesh
