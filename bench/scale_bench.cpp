// scale_bench SPACING MODEL...: draws the same views of models of one scene in different sizes. For each model, prints
// the time of opening it, of the first picture with nothing loaded, and the median wall time and processor time of
// later pictures.

#include <array>
#include <cmath>

#include "base/stopwatch.h"
#include "bench_support.h"

namespace surfcast::bench {
namespace {

struct View {
  const char* name;
  double height;  ///< of the eye above the model's centre, in units of the model's width
  double back;    ///< horizontal distance of the eye from the centre, in the same units
};
constexpr std::array kViews{View{"whole", 1.2, 1.2}, View{"slanted", 0.4, 1.1}};

geometry::Camera camera_of(const geometry::Box& box, const View& view) {
  const double width = box.size().x;
  const glm::dvec3 middle = box.centre();
  return {middle + width * glm::dvec3(0, -view.back, view.height), middle, {0, 0, 1}, 40};
}

struct Timing {
  double open_ms = 0;
  double first_ms = 0;  ///< from before opening to the first picture
  double later_ms = 0;
  double later_processor_ms = 0;
  picture::Frame frame;
};

Timing measure(render::Renderer& renderer, const char* path, const geometry::Camera& camera, double spacing) {
  constexpr int kFrames = 5;
  picture::PictureRequest request;
  request.camera = camera;
  request.spacing = spacing;
  Timing timing;
  const Stopwatch first;
  const std::shared_ptr<const model::ModelFile> model = open_or_exit(path);
  timing.open_ms = first.milliseconds();
  timing.frame = draw_or_exit(renderer, model, request);
  timing.first_ms = first.milliseconds();
  std::vector<double> later;
  std::vector<double> later_processor;
  for (int k = 0; k < kFrames; ++k) {
    const Stopwatch watch;
    const double start = processor_ms();
    draw_or_exit(renderer, model, request);
    later.push_back(watch.milliseconds());
    later_processor.push_back(processor_ms() - start);
  }
  timing.later_ms = median(later);
  timing.later_processor_ms = median(later_processor);
  renderer.release_model(*model);
  return timing;
}

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  using namespace surfcast;
  using namespace surfcast::bench;
  if (argc < 3) {
    std::fprintf(stderr, "usage: scale_bench SPACING MODEL...\n");
    return 2;
  }
  const double spacing = std::atof(argv[1]);
  const std::unique_ptr<render::Renderer> renderer = value_or_exit(render::Renderer::create({}));
  const geometry::Box box = open_or_exit(argv[2])->info().bounds;
  std::printf("%s, 1280 x 720, spacing %g px\n\n", renderer->device().renderer.c_str(), spacing);
  std::printf(
      "| view | model | blocks drawn | surfels drawn | resident MiB | open ms | first ms | frame ms | processor ms "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  for (const View& view : kViews) {
    measure(*renderer, argv[2], camera_of(box, view), spacing);  // warm-up: compiles the shaders, allocates the buffers
    for (int i = 2; i < argc; ++i) {
      const Timing t = measure(*renderer, argv[i], camera_of(box, view), spacing);
      std::printf("| %s | %s | %u | %llu | %.0f | %.1f | %.0f | %.0f | %.0f |\n", view.name,
                  std::filesystem::path(argv[i]).stem().c_str(), t.frame.stats.blocks_drawn,
                  static_cast<unsigned long long>(t.frame.stats.surfels_drawn),
                  static_cast<double>(t.frame.stats.bytes_resident) / (1 << 20), t.open_ms, t.first_ms, t.later_ms,
                  t.later_processor_ms);
    }
  }
  return 0;
}
