// joined_bench WHOLE.surf TILE.surf...: compares pictures of one model with those of its tiles, shown as one. The
// camera flies around the model; both are drawn in turns, with all blocks resident. Prints the medians of wall and
// processor time of a picture, their ratio, the splats drawn, the time to join the tiles, and the PSNR of the last
// pictures.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/stopwatch.h"
#include "bench_support.h"
#include "model/fit_model.h"
#include "render/renderer.h"

namespace {

using namespace surfcast;
using bench::median;
using bench::processor_ms;
using bench::value_or_exit;
using ModelPointer = std::shared_ptr<const model::ModelFile>;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kFrames = 24;

ModelPointer join(const std::vector<std::filesystem::path>& paths) {
  std::vector<model::Member> members;
  for (const std::filesystem::path& path : paths) members.push_back({path.stem().string(), bench::open_or_exit(path)});
  const Stopwatch watch;
  auto joined = std::make_shared<const model::ModelFile>(value_or_exit(model::ModelFile::join(std::move(members))));
  std::printf("joined %zu models of %zu blocks in %.2f ms\n", paths.size(), joined->blocks().size(),
              watch.milliseconds());
  return joined;
}

/// The camera that fits the model, turned about its vertical axis through its focal point.
geometry::Camera turned(const geometry::Camera& camera, double angle) {
  geometry::Camera result = camera;
  const glm::dvec3 arm = camera.position - camera.focal_point;
  result.position = camera.focal_point + glm::dvec3(arm.x * std::cos(angle) - arm.y * std::sin(angle),
                                                    arm.x * std::sin(angle) + arm.y * std::cos(angle), arm.z);
  return result;
}

struct Series {
  std::vector<double> wall;
  std::vector<double> processor;
  std::vector<double> select;
  std::vector<double> splats;
};

picture::Frame draw(render::Renderer& renderer, const ModelPointer& model, const picture::PictureRequest& request,
                    Series& series) {
  const double before = processor_ms();
  const Stopwatch watch;
  picture::Frame frame = bench::draw_or_exit(renderer, model, request);
  series.wall.push_back(watch.milliseconds());
  series.processor.push_back(processor_ms() - before);
  series.splats.push_back(static_cast<double>(frame.stats.surfels_drawn));
  for (const picture::StageTime& stage : frame.stats.stages) {
    if (stage.name == "select") series.select.push_back(stage.milliseconds);
  }
  return frame;
}

double psnr(const picture::Image& a, const picture::Image& b) {
  double squares = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const double difference = static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]);
    if (i % 4 != 3) squares += difference * difference;
  }
  return 10 * std::log10(255.0 * 255.0 * 0.75 * static_cast<double>(a.pixels.size()) / squares);
}

void compare(render::Renderer& renderer, const ModelPointer& whole, const ModelPointer& tiles, double spacing) {
  Series one;
  Series many;
  picture::PictureRequest request;
  request.width = kWidth;
  request.height = kHeight;
  request.spacing = spacing;
  const geometry::Camera start = model::fit_model(*whole, static_cast<double>(kWidth) / kHeight);
  double last_psnr = 0;
  for (int round = 0; round < 2; ++round) {  // the first one loads the blocks
    one = many = {};
    for (int i = 0; i < kFrames; ++i) {
      request.camera = turned(start, 2 * std::numbers::pi * i / kFrames);
      const picture::Frame a = draw(renderer, whole, request, one);
      const picture::Frame b = draw(renderer, tiles, request, many);
      last_psnr = psnr(a.image, b.image);
    }
  }
  std::printf("spacing %g px: one model %.1f ms (processor %.1f, select %.2f), joined %.1f ms (%.1f, %.2f)\n", spacing,
              median(one.wall), median(one.processor), median(one.select), median(many.wall), median(many.processor),
              median(many.select));
  std::printf("  splats: %.0f and %.0f; ratio of splats %.3f, of wall times %.3f, of processor times %.3f; ",
              median(one.splats), median(many.splats), median(many.splats) / median(one.splats),
              median(many.wall) / median(one.wall), median(many.processor) / median(one.processor));
  std::printf("last pictures: %.1f dB\n", last_psnr);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "joined_bench WHOLE.surf TILE.surf...\n");
    return EXIT_FAILURE;
  }
  const ModelPointer whole = bench::open_or_exit(argv[1]);
  const ModelPointer tiles = join({argv + 2, argv + argc});
  const auto renderer = value_or_exit(render::Renderer::create({}));
  std::printf("%s\n", renderer->device().renderer.c_str());
  for (const double spacing : {8.0, 4.0, 2.0, 1.0, 0.0}) compare(*renderer, whole, tiles, spacing);
  return EXIT_SUCCESS;
}
