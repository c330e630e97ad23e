// mesh_laboratory: textured meshes as surfels and as GL draws them, against ray casting; see --help.

#include <CLI/CLI.hpp>
#include <array>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include <unistd.h>

#include "bench_support.h"
#include "builder/build_model.h"
#include "gl/egl_context.h"
#include "lab/markdown_table.h"
#include "lab/mesh_caster.h"
#include "lab/mesh_painter.h"
#include "lab/mesh_scenes.h"
#include "lab/renderer_thread.h"
#include "lab/report.h"
#include "lab/srgb_pictures.h"
#include "lab/text_file.h"
#include "mesh/mesh_reader.h"

namespace surfcast::lab {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMeshPage = "textured-models.md";
constexpr const char* kMeshesBegin = "<!-- meshes: begin -->";
constexpr const char* kMeshesEnd = "<!-- meshes: end -->";

constexpr int kSide = 256;  ///< of the pictures, pixels
constexpr double kViewAngle = 30;
constexpr int kSamples = 4;  ///< of GL's better picture, per pixel, along each axis

/// A view of a scene about the origin.
struct MeshView {
  const char* scene;
  const char* name;
  glm::dvec3 from;  ///< direction of the eye
  double distance;
};

/// The lattices of texels and pixels are turned against each other, as in pictures of anything real.
const glm::dvec3 kFront{0.1, -0.2, 1};
const glm::dvec3 kCorner{0.6, -0.5, 0.9};

std::vector<MeshView> mesh_views() {
  return {{"plane", "close, 0.26 texels a pixel", kFront, 0.485},
          {"plane", "near, 1", kFront, 1.87},
          {"plane", "middle, 2.2", kFront, 4.1},
          {"plane", "far, 5", kFront, 9.33},
          {"plane", "grazing, 75 degrees", {0.3, -3.7, 1}, 3},
          {"cube", "near, 1", kCorner, 4.3},
          {"cube", "middle, 2.2", kCorner, 8},
          {"cube", "far, 5", kCorner, 16.5},
          {"sphere", "near, 1", kCorner, 3.9},
          {"sphere", "middle, 2.2", kCorner, 7.4},
          {"sphere", "far, 5", kCorner, 15.7}};
}

geometry::CameraFrame frame_of(const geometry::Camera& camera) {
  return bench::value_or_exit(make_camera_frame(camera, kSide, kSide));
}

/// The errors of the ways to draw a view.
struct MeshResult {
  MeshView view;
  MeshError surfels;
  MeshError levels;   ///< surfels at a spacing of 1 px
  MeshError sharp;    ///< a mip-map, one sample, without a filter of the pixel
  MeshError blurred;  ///< the same with the prefilter
  MeshError sampled;  ///< kSamples along each axis, with the prefilter
};

/// A scene, ready to be drawn in every way.
class MeshSubject {
 public:
  MeshSubject(const std::string& name, const fs::path& folder, const gl::EglContext&)
      : mesh_(read(name, folder)),
        model_(build(folder / (name + ".obj"), folder / (name + ".surf"))),
        caster_(mesh_),
        painter_(mesh_) {}

  [[nodiscard]] int probes() const { return painter_.probes(); }

  MeshResult measure(const MeshView& view, RendererThread& renderer) const {
    geometry::Camera camera;
    camera.position = view.distance * glm::normalize(view.from);
    camera.focal_point = glm::dvec3(0);
    camera.view_up = {0.3, 1, 0};
    camera.view_angle = kViewAngle;
    const geometry::CameraFrame frame = frame_of(camera);
    const reference::LightPicture ideal = caster_.picture(frame);
    const reference::LightPicture one = painter_.draw(frame, 1);
    const auto surfels = [&](double spacing) { return error_of(ideal, drawn(camera, spacing, renderer)); };
    return {view,
            surfels(0),
            surfels(1),
            error_of(ideal, encode(inner_part(one, reference::kFilterReach))),
            error_of(ideal, encode(reduced(one, 1))),
            error_of(ideal, encode(reduced(painter_.draw(frame, kSamples), kSamples)))};
  }

 private:
  static mesh::Mesh read(const std::string& name, const fs::path& folder) {
    const fs::path file = *write_mesh_scene(name, folder);
    return bench::value_or_exit(mesh::read_mesh(file, mesh::MeshFormat::kObj, {}));
  }

  static std::shared_ptr<const model::ModelFile> build(const fs::path& file, const fs::path& target) {
    bench::value_or_exit(builder::build_model(std::array{file}, target, {}, [](const builder::BuildStep&) {}));
    return bench::open_or_exit(target);
  }

  reference::SrgbPicture drawn(const geometry::Camera& camera, double spacing, RendererThread& renderer) const {
    picture::PictureRequest request;
    request.camera = camera;
    request.width = request.height = kSide;
    request.silhouettes = true;
    request.spacing = spacing;
    reference::SrgbPicture picture;
    renderer.run([&](render::Renderer& r) { picture = picture_of(bench::draw_or_exit(r, model_, request).image); });
    return picture;
  }

  mesh::Mesh mesh_;
  std::shared_ptr<const model::ModelFile> model_;
  MeshCaster caster_;
  MeshPainter painter_;
};

/// The inside is left out where it is the whole picture.
std::string cell(const MeshError& error) {
  const std::string whole = number(error.whole, 1);
  const std::string inside = number(error.inside, 1);
  return whole == inside ? whole : whole + " / " + inside;
}

std::string markdown_of(const std::vector<MeshResult>& results, const std::string& device, int probes) {
  std::string text = "Drawn by " + device + ", with up to " + std::to_string(probes) +
                     " probes. Whole / inside, dB:\n\n" +
                     header({"scene", "view", "surfels", "surfels, `--spacing 1`", "mip-map, 4 x 4 samples, prefilter",
                             "mip-map, 1 sample, prefilter", "mip-map, 1 sample"});
  for (const MeshResult& r : results) {
    text += row(
        {r.view.scene, r.view.name, cell(r.surfels), cell(r.levels), cell(r.sampled), cell(r.blurred), cell(r.sharp)});
  }
  return text + "\n";
}

int main_of(int argc, char** argv) {
  fs::path docs;
  CLI::App app{"Draws textured meshes as surfels and as GL draws them, and compares both with ray casting."};
  app.add_option("--docs", docs, "folder whose textured-models.md gets the table")->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv);
  const fs::path folder = fs::temp_directory_path() / ("surfcast_mesh_laboratory_" + std::to_string(getpid()));
  fs::create_directories(folder);
  RendererThread renderer({});
  const std::unique_ptr<gl::EglContext> context = bench::value_or_exit(gl::EglContext::create(-1));
  std::vector<MeshResult> results;
  int probes = 0;
  for (const std::string& name : mesh_scene_names()) {
    const MeshSubject subject(name, folder, *context);
    probes = subject.probes();
    for (const MeshView& view : mesh_views()) {
      if (view.scene == name) results.push_back(subject.measure(view, renderer));
    }
  }
  fs::remove_all(folder);
  const std::string section = markdown_of(results, context->renderer(), probes);
  std::fputs(section.c_str(), stdout);
  if (docs.empty()) return 0;
  const fs::path page = docs / kMeshPage;
  write_or_exit(page, bench::value_or_exit(with_section(content_of(page), kMeshesBegin, kMeshesEnd, section)));
  return 0;
}

}  // namespace
}  // namespace surfcast::lab

int main(int argc, char** argv) {
  return surfcast::lab::main_of(argc, argv);
}
