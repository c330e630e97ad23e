#include "lab/export_scene.h"

#include <fstream>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "bench_support.h"

namespace surfcast::lab {
namespace {

template <typename T>
void write_value(std::ofstream& file, const T& value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void write_block(std::ofstream& file, const model::DecodedBlock& block, int color_bits) {
  const int step = color_bits == 16 ? 257 : 1;
  for (size_t i = 0; i < block.size(); ++i) {
    write_value(file, block.position(i));
    write_value(file, block.normals[i]);
    write_value(file, block.radii[i]);
    write_value(file, block.colors.empty() ? glm::u8vec3(204) : glm::u8vec3(glm::ivec3(block.colors[i]) / step));
  }
}

void write_surfels(const model::ModelFile& model, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << model.info().surfels
       << "\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\nproperty float ny\n"
          "property float nz\nproperty float radius\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
          "end_header\n";
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    if (model.tree().children(block).count > 0) continue;
    write_block(file, bench::value_or_exit(model.decode(block, model::WantedScalars::kNone)), model.info().color_bits);
  }
}

nlohmann::ordered_json json_of(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

void export_scene(const Subject& subject, const std::filesystem::path& folder) {
  const geometry::Camera& camera = *subject.request.camera;
  const nlohmann::ordered_json description{{"resolution", {subject.request.width, subject.request.height}},
                                           {"surfels", subject.model->info().surfels},
                                           {"camera",
                                            {{"position", json_of(camera.position)},
                                             {"focal_point", json_of(camera.focal_point)},
                                             {"view_up", json_of(camera.view_up)},
                                             {"view_angle", camera.view_angle}}}};
  std::ofstream(folder / (subject.name + ".json")) << description.dump(1) << "\n";
  write_surfels(*subject.model, folder / (subject.name + ".ply"));
  write_ppm(folder / (subject.name + ".ideal.ppm"), subject.ideal);
}

}  // namespace surfcast::lab
