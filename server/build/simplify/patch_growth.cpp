#include "simplify/patch_growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

namespace surfcast::simplify {
namespace {

/// Radius of the smallest neighbourhood in radii of a surfel: 25 samples of an even sampling.
constexpr double kFirstReach = 2.65;
constexpr size_t kFirstSamples = 25;
/// What is noise is estimated from one sample in so many.
constexpr size_t kNoiseStride = 4;
/// Growth of a neighbourhood from step to step.
constexpr double kGrowth = 1.3;
/// How far the residual may exceed the noise, beside the spread of its estimate, which is about one over the root of
/// the samples.
constexpr double kNoise = 1.05;
/// Largest curvature of a neighbourhood times its radius: beyond, the surface leaves its tangent plane too steeply.
constexpr double kMaxBent = 0.7;
/// The ring of a neighbourhood in which every eighth has to have samples, and how many samples that takes.
constexpr double kRing = 0.55;
constexpr size_t kSectors = 8;
constexpr size_t kRingSamples = 60;
/// Steps without enough samples for a fit, of places sampled sparsely.
constexpr int kSparseSteps = 4;
constexpr int kMaxSteps = 40;
/// While a neighbourhood grows, about so many of its samples speak for all. Where it is taken, all are asked.
constexpr size_t kSpeaking = 1024;

Limits limits_of(const ErrorBound& bound, double reach) {
  const double angle = bound.degrees * std::numbers::pi / 180;
  return {angle, bound.height.value_or(kHeightPerAngle * angle * reach)};
}

/// A fit of 6 numbers to 3 equations a sample makes residuals as much too small.
double overfit(size_t samples) {
  constexpr double kShare = 6.0 / 3;
  return 1 / std::sqrt(1 - kShare / static_cast<double>(std::max<size_t>(samples, kMinSamples)));
}

/// The part of two residuals that is the same in both, where the rest of the second one is `growth` times that of the
/// first. Squares add.
double constant_part(double first, double second, double growth) {
  const double square = growth * growth;
  return std::sqrt(std::max(0.0, (square * first * first - second * second) / (square - 1)));
}

/// True if the surface ends within the neighbourhood: a part of the ring has no sample (an edge, a border, a hole).
bool ends_within(const SampledSurface& surface, const surfel::OsculatingSurface& fit, double reach,
                 std::span<const Near> near) {
  if (near.size() < kRingSamples) return false;
  std::array<bool, kSectors> seen{};
  for (const Near& n : near) {
    const glm::dvec2 place = fit.place(surface.position(n.point));
    if (glm::dot(place, place) < kRing * kRing * reach * reach) continue;
    const double turn = 0.5 + 0.5 * std::atan2(place.y, place.x) / std::numbers::pi;
    seen.at(std::min(kSectors - 1, static_cast<size_t>(turn * kSectors))) = true;
  }
  return std::find(seen.begin(), seen.end(), false) != seen.end();
}

}  // namespace

Noise::Noise(const SampledSurface& surface) : surface_(surface) {
  std::vector<std::optional<Limits>> found((surface.size() + kNoiseStride - 1) / kNoiseStride);
  oneapi::tbb::enumerable_thread_specific<Scratch> scratch;
  oneapi::tbb::parallel_for(size_t{0}, found.size(), [&](size_t i) {
    found[i] = estimate(static_cast<uint32_t>(i * kNoiseStride), scratch.local());
  });
  for (size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) continue;
    estimates_.push_back(*found[i]);
    centres_.push_back(surface.position(static_cast<uint32_t>(i * kNoiseStride)));
  }
  tree_.emplace(centres_);
}

Limits Noise::around(uint32_t sample, Scratch& scratch) const {
  tree_->within(surface_.position(sample), 2 * kFirstReach * surface_.radius(sample), scratch.near);
  if (scratch.near.empty()) return {};
  const auto median = [&](double Limits::*value) {
    std::vector<double> values;
    for (const Near& n : scratch.near) values.push_back(estimates_[n.point].*value);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return kNoise * *middle;
  };
  return {median(&Limits::angle), median(&Limits::height)};
}

/// The residual of the surface that fits a neighbourhood.
std::optional<Residual> Noise::within(uint32_t sample, double reach, Scratch& scratch) const {
  surface_.sheet(surface_.position(sample), surface_.normal(sample), reach, scratch.near);
  surface_.load_samples(scratch);
  const auto fit = fit_surface(surface_.position(sample), scratch.samples, surface_.oriented());
  if (!fit) return std::nullopt;
  Residual residual = residual_of(*fit, scratch.samples, surface_.oriented());
  residual.angle *= overfit(scratch.samples.size());
  residual.height *= overfit(scratch.samples.size());
  return residual;
}

std::optional<Limits> Noise::estimate(uint32_t sample, Scratch& scratch) const {
  const double reach = kFirstReach * surface_.radius(sample);
  const std::optional<Residual> first = within(sample, reach, scratch);
  const std::optional<Residual> second = within(sample, kGrowth * reach, scratch);
  if (!first || !second) return std::nullopt;
  return Limits{constant_part(first->angle, second->angle, std::pow(kGrowth, 2)),
                constant_part(first->height, second->height, std::pow(kGrowth, 3))};
}

std::optional<Patch> Growth::fit(uint32_t sample, double reach, const Limits& noise, Scratch& scratch) const {
  surface_.load_samples(scratch);
  const auto fit = fit_surface(surface_.position(sample), scratch.samples, surface_.oriented());
  if (!fit || fit->curvature.largest() * reach > kMaxBent) return std::nullopt;
  const Residual residual = residual_of(*fit, scratch.samples, surface_.oriented());
  const Limits limits = limits_of(bound_, reach);
  const double spread = 1 + 1 / std::sqrt(static_cast<double>(scratch.samples.size()));
  const Limits allowed{std::max(limits.angle, spread * noise.angle), std::max(limits.height, spread * noise.height)};
  if (!allowed.hold(residual) || ends_within(surface_, *fit, reach, scratch.near)) return std::nullopt;
  return Patch{sample, reach, *fit, residual, scratch.near.size()};
}

Patch Growth::grow(uint32_t sample, Scratch& scratch) const {
  Patch best;
  best.sample = sample;
  double reach = kFirstReach * surface_.radius(sample);
  const Limits noise = noise_.around(sample, scratch);
  uint32_t stride = 1;
  size_t before = 0;  // samples of the last step with this stride
  for (int step = 0; step < kMaxSteps; ++step, reach *= kGrowth) {
    surface_.sheet(surface_.position(sample), surface_.normal(sample), reach, scratch.near, stride);
    const size_t samples = scratch.near.size();
    if (best.reach == 0 && step < kSparseSteps && samples < kFirstSamples) continue;
    const std::optional<Patch> next = fit(sample, reach, noise, scratch);
    if (!next) break;
    best = *next;
    best.samples = samples * stride;
    if (samples == before) break;  // nothing is left to grow into
    const bool enough = samples > kSpeaking;
    stride *= enough ? 2 : 1;
    before = enough ? 0 : samples;
  }
  return best;
}

Patch Growth::settle(const Patch& grown, Scratch& scratch) const {
  if (grown.reach == 0) return grown;
  Patch patch = grown;
  if (patch.samples > kSpeaking) patch = shrunk_to_bound(patch, noise_.around(patch.sample, scratch), scratch);
  if (patch.reach > 0) judge(scratch, patch);
  return patch;
}

/// The widest neighbourhood, from that of the patch on, all samples of which keep the bound.
Patch Growth::shrunk_to_bound(const Patch& patch, const Limits& noise, Scratch& scratch) const {
  const double least = 0.99 * kFirstReach * surface_.radius(patch.sample);  // but for rounding, that of the first step
  double reach = patch.reach;
  while (reach >= least) {
    surface_.sheet(surface_.position(patch.sample), surface_.normal(patch.sample), reach, scratch.near);
    if (const std::optional<Patch> kept = fit(patch.sample, reach, noise, scratch)) return *kept;
    reach /= kGrowth;
  }
  Patch none;
  none.sample = patch.sample;
  return none;
}

/// Decides whether the patch needs its curvature.
void Growth::judge(Scratch& scratch, Patch& patch) const {
  surface_.sheet(surface_.position(patch.sample), surface_.normal(patch.sample), patch.reach, scratch.near);
  surface_.load_samples(scratch);
  const Residual flat =
      residual_of(plane_of(patch.surface, scratch.samples, surface_.oriented()), scratch.samples, surface_.oriented());
  patch.curved = gains(patch.residual, flat, patch.reach);
  patch.pays = patch.curved || limits_of(bound_, patch.reach).hold(flat);
}

}  // namespace surfcast::simplify
