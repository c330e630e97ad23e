// through_bench MODEL [FRAMES]: processor time of pictures in which surfels are seen through, beside that of the opaque
// one, of the whole model at 1280 x 720. Prints medians of interleaved frames and their ratios.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "bench_support.h"
#include "model/fit_model.h"
#include "render/renderer.h"

namespace {

using namespace surfcast;

struct Look {
  const char* name;
  double opacity;
  picture::XRay xray;
};

constexpr std::array kLooks{Look{"opaque", 1, picture::XRay::kOff}, Look{"opacity 0.3", 0.3, picture::XRay::kOff},
                            Look{"density 0.1", 0.1, picture::XRay::kDensity}};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "through_bench MODEL [FRAMES]\n");
    return 2;
  }
  const int frames = argc > 2 ? std::atoi(argv[2]) : 5;
  const auto model = bench::open_or_exit(argv[1]);
  const std::unique_ptr<render::Renderer> renderer = bench::value_or_exit(render::Renderer::create({}));
  std::array<std::vector<double>, kLooks.size()> times;
  for (int frame = -1; frame < frames; ++frame) {  // the first one loads and compiles
    for (size_t i = 0; i < kLooks.size(); ++i) {
      picture::PictureRequest request;
      request.camera = model::fit_model(*model, 1280.0 / 720);
      request.width = 1280;
      request.height = 720;
      request.silhouettes = true;
      request.opacity = kLooks[i].opacity;
      request.xray = kLooks[i].xray;
      const double start = bench::processor_ms();
      bench::draw_or_exit(*renderer, model, request);
      if (frame >= 0) times[i].push_back(bench::processor_ms() - start);
    }
  }
  const double opaque = bench::median(times[0]);
  for (size_t i = 0; i < kLooks.size(); ++i) {
    const double ms = bench::median(times[i]);
    std::printf("%-12s %8.0f ms %6.2f\n", kLooks[i].name, ms, ms / opaque);
  }
  return 0;
}
