#include "mesh/mesh_files.h"

#include <cstdlib>
#include <fstream>
#include <iostream>

namespace surfcast::mesh {

MeshFolder::MeshFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "surfcast-mesh-XXXXXX").string();
  path_ = ::mkdtemp(name.data());
}

MeshFolder::~MeshFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path MeshFolder::write(const std::string& name, const std::string& content) const {
  const std::filesystem::path file = path_ / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

std::string targa(int width, int height, const std::function<Texel(int x, int y)>& texel) {
  std::string bytes(18, '\0');
  bytes[2] = 2;  // true colour, not compressed
  bytes[12] = static_cast<char>(width % 256);
  bytes[13] = static_cast<char>(width / 256);
  bytes[14] = static_cast<char>(height % 256);
  bytes[15] = static_cast<char>(height / 256);
  bytes[16] = 32;
  bytes[17] = 0x28;  // from the upper edge, 8 bits of alpha
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto [r, g, b, a] = texel(x, y);
      for (const uint8_t byte : {b, g, r, a}) bytes += static_cast<char>(byte);
    }
  }
  return bytes;
}

void write_square(const MeshFolder& folder, const std::string& image, double side) {
  const std::string s = std::to_string(side);
  folder.write("square.mtl", "newmtl m\nKd 0.6 0.6 0.6\nmap_Kd " + image + "\n");
  folder.write("square.obj", "mtllib square.mtl\nv 0 0 0\nv " + s + " 0 0\nv " + s + " " + s + " 0\nv 0 " + s +
                                 " 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
}

Result<Mesh> read(const std::filesystem::path& path) {
  const std::optional<MeshFormat> format = mesh_format_of(path, FacePolicy::kUse);
  if (!format) return fail(ErrorKind::kUnsupported, "no mesh");
  return read_mesh(path, *format, {});
}

Sampled sample(const Mesh& mesh, const SampleOptions& options) {
  Sampled sampled;
  Result<MeshReport> report = sample_mesh(mesh, options, {}, [&](std::span<const MeshSurfel> surfels) {
    sampled.surfels.insert(sampled.surfels.end(), surfels.begin(), surfels.end());
    return Status();
  });
  if (!report) {
    std::cerr << report.error().message << "\n";
    std::abort();
  }
  sampled.report = *report;
  return sampled;
}

Sampled sample(const std::filesystem::path& path, const SampleOptions& options) {
  const Result<Mesh> mesh = read(path);
  if (!mesh) {
    std::cerr << mesh.error().message << "\n";
    std::abort();
  }
  return sample(*mesh, options);
}

}  // namespace surfcast::mesh
