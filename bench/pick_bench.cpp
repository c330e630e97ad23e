// pick_bench MODEL: measures the processor time of picks on one core, for covered pixels all over a view of the whole
// model: first a pixel, then its neighbour, whose blocks are already decoded.

#include <algorithm>
#include <cstdio>
#include <vector>

#include "bench_support.h"
#include "model/fit_model.h"
#include "pick/pick_surfel.h"

namespace surfcast::bench {
namespace {

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kStep = 80;  // pixels

double pick_ms(const model::ModelFile& model, const geometry::CameraFrame& frame, int x, int y,
               pick::SourceBlocks& blocks, bool& hit) {
  const std::atomic<bool> never{false};
  const double start = processor_ms();
  hit = value_or_exit(pick::pick_surfel(model, {frame, {x + 0.5, y + 0.5}, {}, {}}, blocks, never)).has_value();
  return processor_ms() - start;
}

void print(const char* name, std::vector<double> times) {
  if (times.empty()) return;
  std::sort(times.begin(), times.end());
  std::printf("%s: %zu picks, median %.2f ms, p95 %.2f ms\n", name, times.size(), median(times),
              times[times.size() * 95 / 100]);
}

void measure(const model::ModelFile& model, const geometry::CameraFrame& frame) {
  pick::SourceBlocks blocks(size_t{64} << 20);
  std::vector<double> first;
  std::vector<double> beside;
  for (int y = kStep / 2; y < kHeight; y += kStep) {
    for (int x = kStep / 2; x < kWidth; x += kStep) {
      bool hit = false;
      const double first_ms = pick_ms(model, frame, x, y, blocks, hit);
      if (!hit) continue;
      first.push_back(first_ms);
      beside.push_back(pick_ms(model, frame, x + 1, y, blocks, hit));
    }
  }
  print("first", first);
  print("beside it", beside);
}

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  using namespace surfcast;
  using namespace surfcast::bench;
  if (argc != 2) {
    std::fprintf(stderr, "usage: pick_bench MODEL\n");
    return 2;
  }
  const auto model = open_or_exit(argv[1]);
  const geometry::CameraFrame frame =
      value_or_exit(geometry::make_camera_frame(model::fit_model(*model, double{kWidth} / kHeight), kWidth, kHeight));
  measure(*model, frame);
  return 0;
}
