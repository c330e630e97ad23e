#include "mesh/mesh_format.h"

#include <span>
#include <string>

#include <gtest/gtest.h>

#include "mesh/mesh_files.h"

namespace surfcast::mesh {
namespace {

std::optional<MeshFormat> format_of(const std::string& content, const std::string& name,
                                    FacePolicy faces = FacePolicy::kAuto) {
  return mesh_format_of(std::as_bytes(std::span(content)), name, faces);
}

std::string ply(const std::string& vertex, const std::string& face) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" + vertex +
         "element face 1\nproperty list uchar int vertex_indices\n" + face + "end_header\n";
}

TEST(MeshFormat, ContentDecidesWhateverTheName) {
  EXPECT_EQ(format_of("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "scan.dat"), MeshFormat::kObj);
  EXPECT_EQ(format_of("glTF\2\0\0\0", "x"), MeshFormat::kGlb);
  EXPECT_EQ(format_of(R"({"asset": {"version": "2.0"}})", "x"), MeshFormat::kGltf);
  EXPECT_EQ(format_of("solid a\nfacet normal 0 0 1\n", "x"), MeshFormat::kStl);
}

TEST(MeshFormat, BinaryStlMayBeginWithSolid) {
  std::string file = "solid" + std::string(75, ' ');
  file += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  EXPECT_EQ(format_of(file, "x.stl"), MeshFormat::kStl);
}

TEST(MeshFormat, TablesOfNumbersAreNoMeshes) {
  EXPECT_FALSE(format_of("1 2 3\n4 5 6\n", "a.xyz"));
  EXPECT_FALSE(format_of("x y z\n1 2 3\n", "a.txt"));
}

TEST(MeshFormat, ABinaryScanWithLinesLikeThoseOfObjIsNoMesh) {
  const std::string lines = "\nv 1\nf 1\n";
  EXPECT_FALSE(format_of("LASF" + std::string(20, '\0') + lines, "town.las"));
  EXPECT_EQ(format_of("# a mesh" + lines, "town.las"), MeshFormat::kObj);
}

TEST(MeshFormat, FacesOfPlyCountWhereThereAreColoursOrTextureCoordinates) {
  EXPECT_FALSE(format_of(ply("", ""), "a.ply"));
  EXPECT_EQ(format_of(ply("property uchar red\nproperty uchar green\nproperty uchar blue\n", ""), "a.ply"),
            MeshFormat::kPly);
  EXPECT_EQ(format_of(ply("property float s\nproperty float t\n", ""), "a.ply"), MeshFormat::kPly);
  EXPECT_EQ(format_of(ply("", "property list uchar float texcoord\n"), "a.ply"), MeshFormat::kPly);
  EXPECT_EQ(format_of(ply("", ""), "a.ply", FacePolicy::kUse), MeshFormat::kPly);
  EXPECT_FALSE(format_of(ply("", "property list uchar float texcoord\n"), "a.ply", FacePolicy::kIgnore));
}

}  // namespace
}  // namespace surfcast::mesh
