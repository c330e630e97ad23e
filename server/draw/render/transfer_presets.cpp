#include "render/transfer_presets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

namespace surfcast::render {
namespace {

using picture::TransferPoint;
using picture::TransferPreset;

/// Values from 0 to 1 along the scale of the preset.
constexpr TransferPoint kGrayPoints[] = {{0.05, {0, 0, 0}, 0}, {1, {1, 1, 1}, 0.2}};
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

/// For values above the background, on a scale from there to the brightest ones: the outermost layer is a veil, the
/// brightest values are opaque.
constexpr TransferPoint kContent[] = {{0, {0.45, 0.25, 0.18}, 0},
                                      {0.12, {0.8, 0.55, 0.42}, 0.06},
                                      {0.45, {0.95, 0.8, 0.65}, 0.15},
                                      {1, {1, 1, 0.95}, 0.5}};

std::span<const TransferPoint> points_of(TransferPreset preset) {
  switch (preset) {
    case TransferPreset::kCtBone:
      return kCtBone;
    case TransferPreset::kCtSoft:
      return kCtSoft;
    case TransferPreset::kMr:
      return kMr;
    case TransferPreset::kAuto:
      return kContent;
    case TransferPreset::kGray:
      break;
  }
  return kGrayPoints;
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

constexpr double kSurelyAir = -500;  // Hounsfield units

Scale hounsfield_scale(const model::Volume& volume) {
  constexpr double kAir = -1000;
  constexpr double kWidth = 2000;
  constexpr double kLargestByte = 255;
  if (volume.low < kSurelyAir) return {kAir, kAir + kWidth};
  if (volume.high <= kLargestByte) return {volume.low, volume.high};
  return {volume.low, volume.low + kWidth};
}

/// Whether the values are Hounsfield units: there is air, and there is bone.
bool is_hounsfield(const model::Volume& volume) {
  constexpr double kBone = 300;
  return volume.low < kSurelyAir && volume.high > kBone;
}

/// The value that parts the background from the rest: of all thresholds that which leaves the least variance in both
/// classes (N. Otsu: A threshold selection method from gray-level histograms, 1979, eq. 18).
double background_end(const model::Volume& volume) {
  double count = 0;
  double sum = 0;
  for (size_t i = 0; i < volume.histogram.size(); ++i) {
    count += static_cast<double>(volume.histogram[i]);
    sum += static_cast<double>(volume.histogram[i]) * static_cast<double>(i);
  }
  double best = -1;
  size_t end = 0;  // bins of the background
  double below = 0;
  double sum_below = 0;
  for (size_t i = 0; i + 1 < volume.histogram.size(); ++i) {
    below += static_cast<double>(volume.histogram[i]);
    sum_below += static_cast<double>(volume.histogram[i]) * static_cast<double>(i);
    if (below == 0 || below == count) continue;
    const double apart = sum_below / below - (sum - sum_below) / (count - below);
    const double between = below * (count - below) * apart * apart;
    if (between <= best) continue;
    best = between;
    end = i + 1;
  }
  return volume.low +
         (volume.high - volume.low) * static_cast<double>(end) / static_cast<double>(model::kHistogramBins);
}

/// From the background to the value that few of the others exceed.
Scale content_scale(const model::Volume& volume) {
  constexpr double kBrightest = 0.995;
  const double first = background_end(volume);
  const double last = quantile(volume, kBrightest);
  return {first, last > first ? last : std::max(volume.high, first + 1)};
}

Scale scale_of(TransferPreset preset, const model::Volume& volume) {
  constexpr double kBright = 0.99;
  if (preset == TransferPreset::kCtBone || preset == TransferPreset::kCtSoft) return hounsfield_scale(volume);
  if (preset == TransferPreset::kAuto) return content_scale(volume);
  const double bright = quantile(volume, kBright);
  return {volume.low, bright > volume.low ? bright : volume.high};
}

}  // namespace

std::vector<TransferPoint> preset_points(const picture::Transfer& transfer, const model::Volume& volume) {
  const bool is_ct = transfer.preset == TransferPreset::kAuto && is_hounsfield(volume);
  const TransferPreset preset = is_ct ? TransferPreset::kCtSoft : transfer.preset;
  Scale scale = scale_of(preset, volume);
  scale = {transfer.first.value_or(scale.first), transfer.last.value_or(scale.last)};
  std::vector<TransferPoint> points;
  for (const TransferPoint& point : points_of(preset)) {
    points.push_back({std::lerp(scale.first, scale.last, point.value), point.color, point.opacity});
  }
  return points;
}

}  // namespace surfcast::render
