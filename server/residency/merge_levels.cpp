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

/// Appends the levels of a block to a sequence. Scatter has runs of its own after those of discs.
class Sequencer {
 public:
  explicit Sequencer(std::span<const MergedLevel> levels) : levels_(levels) {
    sequence_.surfels.reserve(kMaxPackedPerSurfel * levels.front().surfels.size());
    const std::vector<MergedSurfel>& finest = levels.front().surfels;
    has_scatter_ = std::any_of(finest.begin(), finest.end(), [](const MergedSurfel& s) { return s.scatter; });
  }

  /// Surfels of intermediate levels that are not in a pair are omitted, because the next level contains them unchanged.
  /// Pairs come first, so they begin at even indices.
  SurfelSequence sequence() && {
    const size_t last = levels_.size() - 1;
    for (size_t level = 0; level < last; ++level) {
      add_runs({.finest = level == 0, .coarsest = false, .pairs = true},
               [&](bool scatter) { put_pairs(level, scatter); });
    }
    add_runs({.finest = last == 0, .coarsest = true}, [&](bool scatter) { put_all(last, scatter); });
    if (last > 0) add_runs({.finest = true, .coarsest = false}, [&](bool scatter) { put_singles(scatter); });
    return std::move(sequence_);
  }

 private:
  /// Adds the surfels that `fill` appends as one run for each kind.
  template <typename Fill>
  void add_runs(PackedRun run, Fill fill) {
    for (const bool scatter : {false, true}) {
      if (scatter && !has_scatter_) return;
      run.scatter = scatter;
      run.first = static_cast<uint32_t>(sequence_.surfels.size());
      fill(scatter);
      run.count = static_cast<uint32_t>(sequence_.surfels.size()) - run.first;
      if (run.count > 0) sequence_.runs.push_back(run);
    }
  }
  void put(size_t level, uint32_t i) { sequence_.surfels.push_back(levels_[level].surfels[i]); }
  void put_pairs(size_t level, bool scatter) {
    for (const MergedFrom& from : levels_[level + 1].from) {
      if (!from.pair() || levels_[level].surfels[from.first].scatter != scatter) continue;
      put(level, from.first);
      put(level, from.second);
    }
  }
  void put_all(size_t level, bool scatter) {
    for (uint32_t i = 0; i < levels_[level].surfels.size(); ++i) {
      if (levels_[level].surfels[i].scatter == scatter) put(level, i);
    }
  }
  void put_singles(bool scatter) {
    for (const MergedFrom& from : levels_[1].from) {
      if (!from.pair() && levels_[0].surfels[from.first].scatter == scatter) put(0, from.first);
    }
  }

  std::span<const MergedLevel> levels_;
  bool has_scatter_ = false;
  SurfelSequence sequence_;
};

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
  const std::vector<MergedLevel> levels = merged_levels(std::move(surfels), oriented);
  SurfelSequence sequence = Sequencer(levels).sequence();
  note_radii(sequence);
  return sequence;
}

}  // namespace surfcast::residency
