#include "lab/subject.h"

#include <array>
#include <fstream>

#include "bench_support.h"
#include "builder/build_model.h"

namespace surfcast::lab {
namespace {

constexpr int kPathSide = 256;  ///< pixels

/// Writes a cloud as a scan: binary PLY with positions in double precision, normals and colours, without radii.
void write_scan(const surfel::SurfelCloud& cloud, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << cloud.size()
       << "\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\nproperty float ny\n"
          "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (size_t i = 0; i < cloud.size(); ++i) {
    const glm::u8vec3 color(cloud.colors->values[i]);
    file.write(reinterpret_cast<const char*>(&cloud.positions[i]), sizeof cloud.positions[i]);
    file.write(reinterpret_cast<const char*>(&cloud.normals[i]), sizeof cloud.normals[i]);
    file.write(reinterpret_cast<const char*>(&color), sizeof color);
  }
}

std::shared_ptr<const model::ModelFile> built_model(const std::filesystem::path& scan,
                                                    const std::filesystem::path& folder) {
  const std::filesystem::path target = folder / (scan.stem().string() + ".surf");
  const std::array inputs{scan};
  bench::value_or_exit(builder::build_model(inputs, target, {}, [](const builder::BuildStep&) {}));
  return bench::open_or_exit(target);
}

std::shared_ptr<const model::ModelFile> model_of(const LabScene& scene, const std::filesystem::path& folder) {
  if (!scene.analytic) {
    return scene.scan.extension() == ".surf" ? bench::open_or_exit(scene.scan) : built_model(scene.scan, folder);
  }
  const std::filesystem::path scan = folder / (scene.name + ".ply");
  write_scan(scene.analytic->cloud, scan);
  return built_model(scan, folder);
}

SrgbPicture ideal_of(const LabScene& scene, const picture::PictureRequest& request, Methods& methods) {
  if (!scene.analytic) return methods.supersampled(request);
  reference::Scene posed = *scene.analytic;
  posed.request = request;
  return encode(ideal_picture(posed));
}

}  // namespace

Subject prepare(const LabScene& scene, const std::filesystem::path& folder, int path_frames, Methods& methods) {
  Subject subject{scene.name, scene.about, model_of(scene, folder), {}, {}, {}, {}};
  methods.open(subject.model);
  if (scene.analytic) {
    subject.request = scene.analytic->request;
  } else {
    subject.request.width = subject.request.height = 512;
    subject.request.shading = picture::Shading::kUnlit;  // the plain methods are unlit, too
    subject.request.camera = methods.camera_of(subject.request);
  }
  subject.ideal = ideal_of(scene, subject.request, methods);
  subject.path = slow_path(subject.request, kPathSide, path_frames);
  for (const picture::PictureRequest& request : subject.path)
    subject.ideal_path.push_back(ideal_of(scene, request, methods));
  return subject;
}

}  // namespace surfcast::lab
