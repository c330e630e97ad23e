// frame_bench [SURFELS] [SIDE] [silhouettes]: compares the time of a per-pixel EWA frame with frames of GL points of
// surfel size, once with all surfels and once with the front-facing ones only. The model is a sphere that fills 80 % of
// the height. The camera moves, and every picture is read back. `silhouettes` refines silhouettes as in a picture at
// rest. Prints medians of one run with interleaved methods.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "bench_support.h"
#include "lab/plain_rasterizer.h"
#include "model/write_model.h"
#include "render/renderer.h"
#include "support/clouds.h"

namespace {

using namespace surfcast;
using bench::median;
using bench::processor_ms;
using bench::value_or_exit;

/// A camera at `angle` radians around a unit sphere, which fills 80 % of the picture's height.
geometry::Camera orbit(double angle) {
  constexpr double kViewAngle = 30;
  const double eta_per_height = 1 / (2 * std::tan(kViewAngle / 2 * 3.14159265358979 / 180));
  const double distance = std::sqrt(1 + std::pow(2 * eta_per_height / 0.8, 2));
  return {{distance * std::sin(angle), 0, distance * std::cos(angle)}, {0, 0, 0}, {0, 1, 0}, kViewAngle};
}

/// Wall time and processor time, milliseconds, or ratios of such times.
struct Taken {
  double wall = 0;
  double processor = 0;
};

template <typename Do>
Taken taken(const Do& something) {
  const Stopwatch watch;
  const double start = processor_ms();
  something();
  return {watch.milliseconds(), processor_ms() - start};
}

void add(const std::string& name, const Taken& figure, std::map<std::string, std::vector<double>>& figures) {
  figures[name].push_back(figure.wall);
  figures[name + ", processor"].push_back(figure.processor);
}

}  // namespace

int main(int argc, char** argv) {
  const size_t surfels = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000000;
  const int side = argc > 2 ? std::atoi(argv[2]) : 1024;
  const bool silhouettes = argc > 3 && std::string(argv[3]) == "silhouettes";
  constexpr int kFrames = 15;
  constexpr int kWarmUp = 2;

  const auto path = std::filesystem::temp_directory_path() / "surfcast_frame_bench.surf";
  value_or_exit(model::write_model(testing::fibonacci_sphere(surfels, 1, {0, 0, 0}, {200, 90, 20}), path, {}));
  const auto model = std::make_shared<const model::ModelFile>(value_or_exit(model::ModelFile::open(path)));
  const std::unique_ptr<render::Renderer> renderer = value_or_exit(render::Renderer::create({}));
  const lab::PlainRasterizer points(*model, side, side);
  std::vector<std::byte> pixels;

  std::map<std::string, std::vector<double>> times;
  uint64_t splats = 0;
  for (int k = 0; k < kFrames + kWarmUp; ++k) {
    picture::PictureRequest request;
    request.camera = orbit(0.03 * k);
    request.width = side;
    request.height = side;
    request.silhouettes = silhouettes;
    const geometry::CameraFrame frame = value_or_exit(geometry::make_camera_frame(*request.camera, side, side));
    const Taken all = taken([&] { points.draw(lab::PlainShape::kPoint, lab::PlainFaces::kAll, frame, pixels); });
    const Taken front = taken([&] { points.draw(lab::PlainShape::kPoint, lab::PlainFaces::kFront, frame, pixels); });
    picture::Frame drawn;
    const Taken ewa = taken([&] { drawn = bench::draw_or_exit(*renderer, model, request); });
    if (k < kWarmUp) continue;
    splats = drawn.stats.surfels_drawn;
    add("points", all, times);
    add("front points", front, times);
    add("ewa", ewa, times);
    add("ewa / points", {ewa.wall / all.wall, ewa.processor / all.processor}, times);
    add("ewa / front points", {ewa.wall / front.wall, ewa.processor / front.processor}, times);
    for (const picture::StageTime& stage : drawn.stats.stages)
      times["ewa: " + stage.name].push_back(stage.milliseconds);
  }
  std::printf("%s, %zu surfels, %d x %d, %llu splats; medians of %d frames\n", renderer->device().renderer.c_str(),
              surfels, side, side, static_cast<unsigned long long>(splats), kFrames);
  for (const auto& [name, values] : times) std::printf("%-30s %8.2f\n", name.c_str(), median(values));
  std::filesystem::remove(path);
  return 0;
}
