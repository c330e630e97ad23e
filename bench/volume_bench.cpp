// volume_bench MODEL [SIDE] [PRESET] [shaded]: processor time of pictures of a volume, the whole of it in view, after
// the first. PRESET: gray, ct-bone, ct-soft, mr. Prints the median and the least of some pictures, and a hash of the
// pixels, by which two programs are seen to draw the same.

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "base/hash.h"
#include "bench_support.h"
#include "render/renderer.h"

int main(int argc, char** argv) {
  using namespace surfcast;
  using picture::TransferPreset;
  constexpr int kPictures = 5;
  if (argc < 2) {
    std::fprintf(stderr, "usage: volume_bench MODEL [SIDE] [PRESET] [shaded]\n");
    return 2;
  }
  const std::map<std::string, TransferPreset> presets{{"gray", TransferPreset::kGray},
                                                      {"ct-bone", TransferPreset::kCtBone},
                                                      {"ct-soft", TransferPreset::kCtSoft},
                                                      {"mr", TransferPreset::kMr}};
  picture::PictureRequest request;
  request.width = request.height = argc > 2 ? std::atoi(argv[2]) : 1024;
  const auto preset = presets.find(argc > 3 ? argv[3] : "ct-soft");
  request.volumes.transfer.preset = preset == presets.end() ? TransferPreset::kGray : preset->second;
  request.volumes.shaded = argc > 4;
  request.format = picture::PixelFormat::kLinearFloat;
  const auto model = bench::open_or_exit(argv[1]);
  const auto renderer = bench::value_or_exit(render::Renderer::create({}));
  picture::Frame frame = bench::draw_or_exit(*renderer, model, request);
  std::vector<double> times;
  for (int i = 0; i < kPictures; ++i) {
    const double start = bench::processor_ms();
    frame = bench::draw_or_exit(*renderer, model, request);
    times.push_back(bench::processor_ms() - start);
  }
  std::printf("%s, %d x %d: median %.0f ms, least %.0f ms of processor time; pixels %016llx\n",
              renderer->device().renderer.c_str(), request.width, request.height, bench::median(times),
              *std::min_element(times.begin(), times.end()),
              static_cast<unsigned long long>(hash_of(std::as_bytes(std::span(frame.image.pixels)))));
  return 0;
}
