#include "simplify/cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

namespace surfcast::simplify {
namespace {

/// A surfel stands for the samples within this share of its neighbourhood.
constexpr double kCovered = 0.62;
/// One sample in so many is a candidate, from level to level; others become one where these leave a gap. Patches of
/// many samples are found by the first levels, so that not each of the samples in them grows a neighbourhood of its
/// own.
constexpr std::array<size_t, 3> kCandidates{1024, 64, 4};
/// A patch is taken at a level if it has so many times the samples that each candidate stands for.
constexpr size_t kWorthTaking = 8;

/// The neighbourhoods of the samples of a level that are not covered yet.
std::vector<Patch> grow_candidates(const SampledSurface& surface, const Growth& growth, const Cover& chosen,
                                   size_t stride) {
  std::vector<Patch> patches((surface.size() + stride - 1) / stride);
  oneapi::tbb::enumerable_thread_specific<Scratch> scratch;
  oneapi::tbb::parallel_for(size_t{0}, patches.size(), [&](size_t i) {
    const auto sample = static_cast<uint32_t>(i * stride);
    if (!chosen.covered(sample)) patches[i] = growth.grow(sample, scratch.local());
  });
  std::erase_if(patches, [](const Patch& p) { return p.reach == 0; });
  return patches;
}

/// A neighbourhood is at most twice as wide as those of the candidates within its cover: surfels of very different
/// sizes beside each other leave gaps or lie over each other.
void grade(const SampledSurface& surface, std::vector<Patch>& patches) {
  const std::vector<glm::dvec3> centres = centres_of(surface, patches);
  const PointTree tree(centres);
  std::vector<double> reach(patches.size());
  oneapi::tbb::enumerable_thread_specific<std::vector<Near>> near;
  oneapi::tbb::parallel_for(size_t{0}, patches.size(), [&](size_t i) {
    std::vector<Near>& found = near.local();
    tree.within(centres[i], kCovered * patches[i].reach, found);
    reach[i] = patches[i].reach;
    for (const Near& n : found) reach[i] = std::min(reach[i], 2 * patches[n.point].reach);
  });
  for (size_t i = 0; i < patches.size(); ++i) patches[i].reach = reach[i];
}

/// Takes the candidates of a level from wide to narrow.
void cover_level(const SampledSurface& surface, const Growth& growth, size_t level, Cover& chosen, Scratch& scratch) {
  const size_t stride = kCandidates.at(level);
  std::vector<Patch> candidates = grow_candidates(surface, growth, chosen, stride);
  grade(surface, candidates);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Patch& a, const Patch& b) { return a.reach > b.reach; });
  const size_t least = level + 1 < kCandidates.size() ? kWorthTaking * stride : 0;
  for (const Patch& patch : candidates) {
    if (!chosen.covered(patch.sample) && patch.samples >= least) chosen.take(growth.settle(patch, scratch), scratch);
  }
}

}  // namespace

std::vector<glm::dvec3> centres_of(const SampledSurface& surface, const std::vector<Patch>& patches) {
  std::vector<glm::dvec3> centres;
  centres.reserve(patches.size());
  for (const Patch& p : patches) centres.push_back(surface.position(p.sample));
  return centres;
}

void Cover::take(const Patch& patch, Scratch& scratch) {
  const auto number = static_cast<uint32_t>(patches_.size());
  patches_.push_back(patch);
  const glm::dvec3& centre = surface_.position(patch.sample);
  surface_.sheet(centre, surface_.normal(patch.sample), kCovered * patch.reach, scratch.near);
  for (const Near& n : scratch.near) claim(n.point, number, std::sqrt(n.square) / std::max(patch.reach, 1e-300));
  claim(patch.sample, number, -1);
}

void Cover::release_patches_below(size_t samples) {
  std::vector<size_t> counts(patches_.size(), 0);
  for (const uint32_t owner : owner_) ++counts[owner];
  std::vector<uint32_t> numbers(patches_.size(), kNobody);
  std::vector<Patch> kept;
  for (size_t i = 0; i < patches_.size(); ++i) {
    if (counts[i] < samples) continue;
    numbers[i] = static_cast<uint32_t>(kept.size());
    kept.push_back(patches_[i]);
  }
  for (uint32_t sample = 0; sample < owner_.size(); ++sample) {
    uint32_t& owner = owner_[sample];
    owner = numbers[owner];
    if (owner != kNobody) continue;
    owner = static_cast<uint32_t>(kept.size());
    Patch alone;
    alone.sample = sample;
    kept.push_back(alone);
  }
  patches_ = std::move(kept);
}

void Cover::claim(uint32_t sample, uint32_t patch, double nearness) {
  if (covered(sample) && nearness_[sample] <= nearness) return;
  owner_[sample] = patch;
  nearness_[sample] = nearness;
}

/// Takes patches until all samples are covered. What the candidates leave is covered by new ones.
Cover cover(const SampledSurface& surface, const ErrorBound& bound) {
  const Growth growth(surface, bound);
  Cover chosen(surface);
  Scratch scratch;
  for (size_t level = 0; level < kCandidates.size(); ++level) cover_level(surface, growth, level, chosen, scratch);
  for (uint32_t sample = 0; sample < surface.size(); ++sample) {
    if (!chosen.covered(sample)) chosen.take(growth.settle(growth.grow(sample, scratch), scratch), scratch);
  }
  return chosen;
}

}  // namespace surfcast::simplify
