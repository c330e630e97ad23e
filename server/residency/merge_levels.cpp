#include "residency/merge_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "shared/frame_layout.h"

namespace surfcast::residency {
namespace {

/// Levels of fewer surfels are not merged further: they cost too little.
constexpr size_t kFewest = 256;
/// For blocks of source surfels, the next coarser level of the LDC tree has at most four times the spacing.
constexpr size_t kMaxMerges = 3;
/// A merged level is worth its memory if it has at most this share of the surfels of the finer level.
constexpr double kLargestPart = 0.75;

/// The levels of a block from fine to coarse, beginning with its own surfels.
std::vector<MergedLevel> merged_levels(std::vector<MergedSurfel> surfels, bool oriented) {
  const size_t most = kMaxPackedPerSurfel * surfels.size();
  size_t total = surfels.size();
  std::vector<MergedLevel> levels;
  levels.push_back({std::move(surfels), {}});
  while (levels.back().surfels.size() >= kFewest && levels.size() <= kMaxMerges) {
    const size_t finer = levels.back().surfels.size();
    MergedLevel next = merge_surfels(levels.back().surfels, oriented);
    total += next.surfels.size();
    if (static_cast<double>(next.surfels.size()) > kLargestPart * static_cast<double>(finer) || total > most) break;
    levels.push_back(std::move(next));
  }
  return levels;
}

/// Adds the surfels that `fill` appends as one run.
template <typename Fill>
void add_run(SurfelSequence& sequence, PackedRun run, Fill fill) {
  run.first = static_cast<uint32_t>(sequence.surfels.size());
  fill();
  run.count = static_cast<uint32_t>(sequence.surfels.size()) - run.first;
  if (run.count > 0) sequence.runs.push_back(std::move(run));
}

/// Surfels of intermediate levels that are not in a pair are omitted, because the next level contains them unchanged.
/// Pairs come first, so they begin at even indices.
SurfelSequence sequence_of(std::span<const MergedLevel> levels) {
  SurfelSequence sequence;
  sequence.surfels.reserve(kMaxPackedPerSurfel * levels.front().surfels.size());
  const auto put = [&](size_t level, uint32_t i) { sequence.surfels.push_back(levels[level].surfels[i]); };
  for (size_t level = 0; level + 1 < levels.size(); ++level) {
    add_run(sequence, {.finest = level == 0, .coarsest = false, .pairs = true}, [&] {
      for (const MergedFrom& from : levels[level + 1].from) {
        if (!from.pair()) continue;
        put(level, from.first);
        put(level, from.second);
      }
    });
  }
  const size_t last = levels.size() - 1;
  add_run(sequence, {.finest = last == 0, .coarsest = true}, [&] {
    for (uint32_t i = 0; i < levels[last].surfels.size(); ++i) put(last, i);
  });
  if (last == 0) return sequence;
  add_run(sequence, {.finest = true, .coarsest = false}, [&] {
    for (const MergedFrom& from : levels[1].from) {
      if (!from.pair()) put(0, from.first);
    }
  });
  return sequence;
}

/// The radii of the chunk that begins with surfel `first`.
PackedRun::Radii radii_of(const SurfelSequence& sequence, const PackedRun& run, uint32_t first) {
  const uint32_t end = std::min<uint32_t>(first + SURFCAST_CHUNK, run.first + run.count);
  PackedRun::Radii radii{std::numeric_limits<float>::max(), 0};
  for (uint32_t i = first; i < end; ++i) {
    const float own = sequence.surfels[i].radius;
    const float merged = run.pairs ? std::hypot(own, sequence.surfels[i ^ 1].radius) : own;
    radii.least = std::min(radii.least, own);
    radii.largest_merged = std::max(radii.largest_merged, merged);
  }
  return radii;
}

void note_radii(SurfelSequence& sequence) {
  for (PackedRun& run : sequence.runs) {
    for (uint32_t i = 0; i < run.count; i += SURFCAST_CHUNK) {
      run.chunks.push_back(radii_of(sequence, run, run.first + i));
    }
  }
}

}  // namespace

SurfelSequence merge_levels(std::vector<MergedSurfel> surfels, bool oriented) {
  SurfelSequence sequence = sequence_of(merged_levels(std::move(surfels), oriented));
  note_radii(sequence);
  return sequence;
}

}  // namespace surfcast::residency
