#include "lab/subject.h"

#include <array>
#include <cstdio>
#include <cstdlib>

#include "bench_support.h"
#include "builder/build_model.h"
#include "lab/colored_points.h"
#include "scan/scan_stream.h"

namespace surfcast::lab {
namespace {

constexpr int kPathSide = 256;  ///< pixels

/// The points of a cloud, without its radii.
LabPoints points_of(const surfel::SurfelCloud& cloud) {
  LabPoints points{cloud.positions, {}, {}, cloud.normals, cloud.z_up};
  for (const glm::u16vec3& color : cloud.colors->values) points.colors.emplace_back(color);
  return points;
}

/// The model of a scan: as it is if it is a model or has colours.
std::shared_ptr<const model::ModelFile> scanned_model(const std::filesystem::path& scan,
                                                      const std::filesystem::path& folder) {
  if (scan.extension() == ".surf") return bench::open_or_exit(scan);
  if (bench::value_or_exit(scan::ScanStream::open(scan)).schema().color_bits > 0)
    return built_model(scan, folder, std::nullopt);
  const LabPoints points = colored_points(scan);
  const std::filesystem::path colored = folder / (scan.stem().string() + ".ply");
  write_or_exit(points, colored);
  return built_model(colored, folder, points.z_up);
}

std::shared_ptr<const model::ModelFile> model_of(const LabScene& scene, const std::filesystem::path& folder) {
  if (!scene.analytic) return scanned_model(scene.scan, folder);
  const std::filesystem::path scan = folder / (scene.name + ".ply");
  write_or_exit(points_of(scene.analytic->cloud), scan);
  return built_model(scan, folder, std::nullopt);
}

SrgbPicture ideal_of(const LabScene& scene, const picture::PictureRequest& request, Methods& methods) {
  if (!scene.analytic) return methods.supersampled(request);
  reference::Scene posed = *scene.analytic;
  posed.request = request;
  return encode(ideal_picture(posed));
}

}  // namespace

std::shared_ptr<const model::ModelFile> built_model(const std::filesystem::path& scan,
                                                    const std::filesystem::path& folder, std::optional<bool> z_up) {
  const std::filesystem::path target = folder / (scan.stem().string() + ".surf");
  builder::BuildOptions options;
  options.z_up = z_up;
  bench::value_or_exit(builder::build_model(std::array{scan}, target, options, [](const builder::BuildStep&) {}));
  return bench::open_or_exit(target);
}

LabPoints colored_points(const std::filesystem::path& scan) {
  LabPoints points = bench::value_or_exit(read_points(scan));
  if (points.colors.empty()) points.colors = colors_for(points);
  return points;
}

void write_or_exit(const LabPoints& points, const std::filesystem::path& path) {
  if (write_ply(points, path)) return;
  std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
  std::exit(1);
}

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
