// glyph_bench INPUT [SIDE] [ideal] [superquadric] [moving SPACING] [export FOLDER]: pictures of a tensor field or a
// table of ellipsoids, the whole of it in view, at rest and in motion at full size: wall and processor time after the
// first picture, the stages, and with `ideal` dB beside 8 x 8 exact samples a pixel in double precision. INPUT: what
// `surfcastd build` reads, or a model. `moving`: the picture in motion is that of a view which moves, with as many
// glyphs as it may have at this spacing, in pixels. `export` writes the glyphs, the camera and the ideal picture for
// bench/peers/glyphs.py.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "base/stopwatch.h"
#include "bench_support.h"
#include "builder/build_model.h"
#include "ellipsoid/ellipsoid_block.h"
#include "reference/ellipsoid_renderer.h"
#include "render/renderer.h"

namespace {

using namespace surfcast;

/// The ellipsoids of the leaves at the default scale, coloured by their directions.
std::vector<reference::EllipsoidGlyph> glyphs_of(const model::ModelFile& model) {
  std::vector<reference::EllipsoidGlyph> glyphs;
  for (uint32_t b = 0; b < model.blocks().size(); ++b) {
    if (model.blocks()[b].level > 0) continue;
    const auto stored = bench::value_or_exit(model.stored(b));
    const auto block = bench::value_or_exit(ellipsoid::decode_ellipsoids(stored, model.ellipsoid_sources()));
    const double scale = model.ellipsoid_sources()[block.source].scale();
    for (size_t i = 0; i < block.size(); ++i) {
      reference::EllipsoidGlyph glyph{
          block.position(i), glm::dvec3(block.values[i]), glm::normalize(glm::dquat(block.rotations[i])), {}, {}};
      glyph.color = reference::direction_color(glyph);
      glyph.values *= scale;
      glyphs.push_back(glyph);
    }
  }
  return glyphs;
}

reference::SrgbPicture codes_of(const picture::Image& image) {
  reference::SrgbPicture picture{image.width, image.height, {}};
  for (size_t i = 0; i < image.pixels.size(); i += 4) {
    picture.pixels.emplace_back(uint8_t(image.pixels[i]), uint8_t(image.pixels[i + 1]), uint8_t(image.pixels[i + 2]));
  }
  return picture;
}

std::string stages_of(const picture::FrameStats& stats) {
  std::string text;
  for (const picture::StageTime& stage : stats.stages) {
    if (stage.milliseconds >= 0.5) text += ", " + stage.name + " " + std::to_string(std::lround(stage.milliseconds));
  }
  return text;
}

/// Tensors whose eigenvalues are the semi-axes, and linear colours: 15 numbers of double precision each.
void export_scene(const std::filesystem::path& folder, const std::vector<reference::EllipsoidGlyph>& glyphs,
                  const geometry::Camera& camera, const reference::SrgbPicture& exact) {
  std::ofstream binary(folder / "glyphs.bin", std::ios::binary);
  for (const reference::EllipsoidGlyph& glyph : glyphs) {
    const glm::dmat3 axes = glm::mat3_cast(glyph.rotation);
    const glm::dmat3 scaled(glyph.values.x * axes[0], glyph.values.y * axes[1], glyph.values.z * axes[2]);
    const glm::dmat3 tensor = scaled * glm::transpose(axes);
    binary.write(reinterpret_cast<const char*>(&glyph.centre), sizeof glyph.centre);
    binary.write(reinterpret_cast<const char*>(&tensor), sizeof tensor);
    binary.write(reinterpret_cast<const char*>(&glyph.color), sizeof glyph.color);
  }
  const auto list = [](const glm::dvec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
  const nlohmann::json facts{{"resolution", {exact.width, exact.height}},
                             {"camera",
                              {{"position", list(camera.position)},
                               {"focal_point", list(camera.focal_point)},
                               {"view_up", list(camera.view_up)},
                               {"view_angle", camera.view_angle}}}};
  std::ofstream(folder / "glyphs.json") << facts;
  write_ppm(folder / "glyphs.ideal.ppm", exact);
}

/// Draws a few times. Prints the least times.
picture::Frame measure(render::Renderer& renderer, const std::shared_ptr<const model::ModelFile>& model,
                       const picture::PictureRequest& request) {
  constexpr int kPictures = 5;
  picture::Frame frame = bench::draw_or_exit(renderer, model, request);
  std::vector<double> wall;
  std::vector<double> processor;
  for (int i = 0; i < kPictures; ++i) {
    const double start = bench::processor_ms();
    const Stopwatch watch;
    frame = bench::draw_or_exit(renderer, model, request);
    wall.push_back(watch.milliseconds());
    processor.push_back(bench::processor_ms() - start);
  }
  std::printf("%s: %llu ellipsoids, wall %.0f ms, processor %.0f ms (least of %d)%s\n",
              request.blends_behind ? "in motion" : "at rest",
              static_cast<unsigned long long>(frame.stats.surfels_drawn), *std::ranges::min_element(wall),
              *std::ranges::min_element(processor), kPictures, stages_of(frame.stats).c_str());
  return frame;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: glyph_bench INPUT [SIDE] [ideal] [superquadric] [moving SPACING] [export FOLDER]\n");
    return 2;
  }
  std::filesystem::path path = argv[1];
  const bool built = path.extension() != ".surf";
  if (built) {
    const auto target = std::filesystem::temp_directory_path() / ("glyphs" + std::to_string(getpid()) + ".surf");
    bench::value_or_exit(builder::build_model(std::vector{path}, target, {}, [](const builder::BuildStep&) {}));
    path = target;
  }
  const auto model = bench::open_or_exit(path.c_str());
  const std::vector<std::string_view> words(argv + 2, argv + argc);
  const bool ideal =
      std::ranges::any_of(words, [](std::string_view word) { return word == "ideal" || word == "export"; });
  picture::PictureRequest request;
  request.width = request.height = argc > 2 && std::atoi(argv[2]) > 0 ? std::atoi(argv[2]) : 1024;
  if (std::ranges::find(words, "superquadric") != words.end()) {
    request.glyphs.shape = picture::GlyphShape::kSuperquadric;
  }
  const auto renderer = bench::value_or_exit(render::Renderer::create({}));
  const picture::Frame rest = measure(*renderer, model, request);
  request.blends_behind = true;
  const auto moving = std::ranges::find(words, "moving");
  if (moving != words.end() && moving + 1 != words.end()) {
    request.spacing = std::atof(std::string(*(moving + 1)).c_str());
    request.rest_spacing = 0;
  }
  const picture::Frame motion = measure(*renderer, model, request);
  if (const char* folder = std::getenv("SURFCAST_BENCH_PICTURES")) {
    reference::write_ppm(std::filesystem::path(folder) / "glyphs_rest.ppm", codes_of(rest.image));
    reference::write_ppm(std::filesystem::path(folder) / "glyphs_motion.ppm", codes_of(motion.image));
  }
  if (ideal) {
    const auto frame = bench::value_or_exit(geometry::make_camera_frame(rest.camera, request.width, request.height));
    const std::vector<reference::EllipsoidGlyph> glyphs = glyphs_of(*model);
    const auto exact = encode(reference::ellipsoid_picture(glyphs, frame, 8));
    const auto folder = std::ranges::find(words, "export");
    if (folder != words.end() && folder + 1 != words.end()) export_scene(*(folder + 1), glyphs, rest.camera, exact);
    std::printf("%.1f dB at rest, %.1f dB in motion\n", psnr(codes_of(rest.image), exact),
                psnr(codes_of(motion.image), exact));
  }
  if (built) std::filesystem::remove(path);
  return 0;
}
