#include <cstring>

#include <gtest/gtest.h>

#include "mesh/mesh_files.h"

namespace surfcast::mesh {
namespace {

std::string binary_stl(const std::string& head, uint32_t count) {
  std::string file = head + std::string(80 - head.size(), ' ');
  file.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (uint32_t i = 0; i < count; ++i) {
    const std::array<float, 12> numbers{0, 0, 1, 0, 0, static_cast<float>(i), 1, 0, 0, 0, 1, 0};
    file.append(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
    file.append(2, '\0');
  }
  return file;
}

TEST(StlReader, ABinaryFileMayBeginWithSolid) {
  const MeshFolder folder;
  const Result<Mesh> mesh = read(folder.write("a.stl", binary_stl("solid part", 3)));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles(), 3U);
  EXPECT_EQ(mesh->patches[0].vertices->positions[3], glm::dvec3(0, 0, 1));
}

TEST(StlReader, TextIsRead) {
  const MeshFolder folder;
  const Result<Mesh> mesh = read(folder.write(
      "a.stl",
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1.5e0 0\nendloop\nendfacet\n"
      "endsolid\n"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles(), 1U);
  EXPECT_EQ(mesh->patches[0].vertices->positions[2], glm::dvec3(0, 1.5, 0));
}

TEST(StlReader, ATruncatedFileIsAnError) {
  const MeshFolder folder;
  std::string file = binary_stl("part", 3);
  file.resize(file.size() - 20);
  EXPECT_FALSE(read(folder.write("a.stl", file)));
  EXPECT_FALSE(read(folder.write("b.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n")));
}

}  // namespace
}  // namespace surfcast::mesh
