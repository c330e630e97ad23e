#include "render/transfer_presets.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

namespace surfcast::render {
namespace {

using picture::TransferPoint;
using picture::TransferPreset;

/// Values from 0 to 1 along the scale of the preset.
constexpr TransferPoint kGray[] = {{0.05, {0, 0, 0}, 0}, {1, {1, 1, 1}, 0.2}};
constexpr TransferPoint kMr[] = {{0.12, {0.35, 0.2, 0.15}, 0},
                                 {0.25, {0.75, 0.5, 0.4}, 0.06},
                                 {0.5, {0.95, 0.8, 0.65}, 0.15},
                                 {1, {1, 1, 0.95}, 0.4}};
constexpr TransferPoint kCtBone[] = {
    {0.565, {0.75, 0.45, 0.3}, 0}, {0.6, {0.9, 0.75, 0.55}, 0.15}, {0.7, {1, 0.95, 0.85}, 0.6}, {1, {1, 1, 1}, 0.9}};
constexpr TransferPoint kCtSoft[] = {{0.3, {0.75, 0.5, 0.4}, 0},
                                     {0.42, {0.9, 0.65, 0.5}, 0.08},
                                     {0.48, {0.9, 0.6, 0.45}, 0.1},
                                     {0.53, {0.8, 0.3, 0.25}, 0.2},
                                     {0.58, {0.9, 0.5, 0.4}, 0.3},
                                     {0.65, {1, 0.95, 0.85}, 0.6},
                                     {1, {1, 1, 1}, 0.9}};

std::span<const TransferPoint> points_of(TransferPreset preset) {
  switch (preset) {
    case TransferPreset::kCtBone:
      return kCtBone;
    case TransferPreset::kCtSoft:
      return kCtSoft;
    case TransferPreset::kMr:
      return kMr;
    case TransferPreset::kGray:
      break;
  }
  return kGray;
}

struct Scale {
  double first = 0;
  double last = 1;
};

/// The value that the given share of the samples does not exceed.
double quantile(const model::Volume& volume, double share) {
  const uint64_t all = std::accumulate(volume.histogram.begin(), volume.histogram.end(), uint64_t{0});
  const double bin = (volume.high - volume.low) / static_cast<double>(model::kHistogramBins);
  uint64_t below = 0;
  for (size_t i = 0; i < volume.histogram.size(); ++i) {
    below += volume.histogram[i];
    if (static_cast<double>(below) >= share * static_cast<double>(all)) {
      return volume.low + bin * static_cast<double>(i + 1);
    }
  }
  return volume.high;
}

Scale hounsfield_scale(const model::Volume& volume) {
  constexpr double kAir = -1000;
  constexpr double kWidth = 2000;
  constexpr double kSurelyAir = -500;
  constexpr double kLargestByte = 255;
  if (volume.low < kSurelyAir) return {kAir, kAir + kWidth};
  if (volume.high <= kLargestByte) return {volume.low, volume.high};
  return {volume.low, volume.low + kWidth};
}

Scale scale_of(TransferPreset preset, const model::Volume& volume) {
  constexpr double kBright = 0.99;
  if (preset == TransferPreset::kCtBone || preset == TransferPreset::kCtSoft) return hounsfield_scale(volume);
  const double bright = quantile(volume, kBright);
  return {volume.low, bright > volume.low ? bright : volume.high};
}

}  // namespace

std::vector<TransferPoint> preset_points(const picture::Transfer& transfer, const model::Volume& volume) {
  Scale scale = scale_of(transfer.preset, volume);
  scale = {transfer.first.value_or(scale.first), transfer.last.value_or(scale.last)};
  std::vector<TransferPoint> points;
  for (const TransferPoint& point : points_of(transfer.preset)) {
    points.push_back({std::lerp(scale.first, scale.last, point.value), point.color, point.opacity});
  }
  return points;
}

}  // namespace surfcast::render
