#include "view/video_budget.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace surfcast::view {
namespace {

constexpr int kBestFile = 85;  // quality
constexpr int kGoodFile = 75;  // a JPEG of less shows its blocks

/// Bytes of a file relative to one of quality 85.
double relative_bytes(int quality) {
  constexpr double kSteepness = 45;  // of the exponential
  return std::exp((quality - kBestFile) / kSteepness);
}

}  // namespace

double video_frame_ms(double fps) {
  constexpr double kMax = 16;     // and up to half more, because the rate is estimated too high
  constexpr double kShare = 0.8;  // of the time between two frames
  return std::min(kMax, kShare * 1000 / fps);
}

size_t video_bytes(size_t link_bytes, size_t depth_bytes) {
  constexpr size_t kMin = 3000;  // fewer frames are better than ones of still less
  return std::max(link_bytes - std::min(link_bytes, depth_bytes), kMin);
}

double video_scale(size_t bytes, double pixels) {
  constexpr double kMinDensity = 0.002;  // bytes for each pixel
  constexpr std::array kScales{1.0, 0.75, 0.5, 0.375};
  constexpr double kSmallest = 0.25;
  const double fits = std::sqrt(static_cast<double>(bytes) / (kMinDensity * pixels));
  const auto* scale = std::ranges::find_if(kScales, [fits](double one) { return one <= fits; });
  return scale == kScales.end() ? kSmallest : *scale;
}

double jpeg_density(size_t bytes, double pixels, int quality) {
  return static_cast<double>(bytes) / pixels / relative_bytes(quality);
}

double good_file_bytes(double density, double pixels) {
  return density * pixels * relative_bytes(kGoodFile);
}

bool wants_video(double file_bytes, double link_bytes, bool is_video) {
  constexpr double kFits = 0.6;  // of the link: files are used from here on
  return file_bytes > (is_video ? kFits : 1) * link_bytes;
}

}  // namespace surfcast::view
