#include "video/quantizer.h"

#include <algorithm>
#include <cmath>

#include "video/codec_module.h"

namespace surfcast::video {
namespace {

constexpr int kFinestWorthwhile = 12;  // finer ones show nothing more than a JPEG of quality 85

/// The complexity of a picture that took so many bytes.
double complexity_of(double steepness, int quantizer, double bytes, double pixels) {
  return std::log2(std::max(bytes, 1.0) / pixels) + steepness * quantizer;
}

}  // namespace

SizeModel sizes_after_key(int quantizer, double bytes, double pixels) {
  constexpr double kSteepness = 0.11;
  return {complexity_of(kSteepness, quantizer, bytes, pixels), kSteepness};
}

SizeModel sizes_of_larger(const SizeModel& model) {
  constexpr double kMore = 0.6;
  return {model.complexity + kMore, model.steepness};
}

int quantizer_for(const SizeModel& model, double bytes, double pixels) {
  const double wanted = (model.complexity - std::log2(std::max(bytes, 1.0) / pixels)) / model.steepness;
  return static_cast<int>(std::ceil(std::clamp<double>(wanted, kFinestWorthwhile, kCoarsestQuantizer)));
}

SizeModel learned(const SizeModel& model, int quantizer, double bytes, double pixels) {
  const double seen = complexity_of(model.steepness, quantizer, bytes, pixels);
  return {seen > model.complexity ? seen : (model.complexity + seen) / 2, model.steepness};
}

}  // namespace surfcast::video
