#include "residency/merge_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "shared/frame_layout.h"

namespace surfcast::residency {
namespace {

/// Blocks, and levels of a block, of fewer surfels are not merged further: they cost too little.
constexpr size_t kFewest = 256;
/// For blocks of source surfels, the next coarser level of the LDC tree has at most four times the spacing.
constexpr size_t kMaxMerges = 3;
/// A merged level is worth its memory if it has at most this share of the surfels of the finer level.
constexpr double kLargestPart = 0.75;

/// The levels of the discs of a block, or of its scatter, from fine to coarse, beginning with its own surfels.
using Ladder = std::vector<MergedLevel>;

/// `fewest`: levels of fewer surfels are not merged further.
Ladder merged_levels(std::vector<MergedSurfel> surfels, bool oriented, size_t fewest) {
  const size_t most = kMaxPackedPerSurfel * surfels.size();
  size_t total = surfels.size();
  Ladder levels;
  levels.push_back({std::move(surfels), {}});
  while (levels.back().surfels.size() >= fewest && levels.size() <= kMaxMerges) {
    const size_t finer = levels.back().surfels.size();
    MergedLevel next = merge_surfels(levels.back().surfels, oriented);
    total += next.surfels.size();
    if (static_cast<double>(next.surfels.size()) > kLargestPart * static_cast<double>(finer) || total > most) break;
    levels.push_back(std::move(next));
  }
  return levels;
}

/// Discs and scatter, if there is any, are merged each for themselves: where one has no neighbours to merge, the other
/// may have.
std::vector<Ladder> ladders_of(std::vector<MergedSurfel> surfels, bool oriented) {
  const size_t all = surfels.size();
  const auto scatter = std::stable_partition(surfels.begin(), surfels.end(), [](const auto& s) { return !s.scatter; });
  std::vector<MergedSurfel> others(scatter, surfels.end());
  surfels.erase(scatter, surfels.end());
  std::vector<Ladder> ladders;
  for (std::vector<MergedSurfel>* kind : {&surfels, &others}) {
    const size_t fewest = (kFewest * kind->size() + all - 1) / all;
    if (!kind->empty()) ladders.push_back(merged_levels(std::move(*kind), oriented, fewest));
  }
  return ladders;
}

/// Appends the levels of a block to a sequence. Scatter has runs of its own beside those of discs.
class Sequencer {
 public:
  Sequencer(std::span<const Ladder> ladders, size_t surfels) : ladders_(ladders) {
    sequence_.surfels.reserve(kMaxPackedPerSurfel * surfels);
  }

  /// Surfels of intermediate levels that are not in a pair are omitted, because the next level contains them unchanged.
  /// Pairs come first, so they begin at even indices.
  SurfelSequence sequence() && {
    for (size_t level = 0; level < kMaxMerges; ++level) {
      for (const Ladder& levels : ladders_) {
        if (level + 1 < levels.size()) put_pairs(levels, level);
      }
    }
    for (const Ladder& levels : ladders_) {
      add_run({.finest = levels.size() == 1, .coarsest = true}, [&] { put_all(levels.back()); });
    }
    for (const Ladder& levels : ladders_) {
      if (levels.size() > 1) add_run({.finest = true, .coarsest = false}, [&] { put_singles(levels); });
    }
    return std::move(sequence_);
  }

 private:
  /// Adds the surfels that `fill` appends, all of one kind, as a run.
  template <typename Fill>
  void add_run(PackedRun run, Fill fill) {
    run.first = static_cast<uint32_t>(sequence_.surfels.size());
    fill();
    run.count = static_cast<uint32_t>(sequence_.surfels.size()) - run.first;
    if (run.count == 0) return;
    run.scatter = sequence_.surfels.back().scatter;
    sequence_.runs.push_back(std::move(run));
  }
  void put_pairs(const Ladder& levels, size_t level) {
    add_run({.finest = level == 0, .coarsest = false, .pairs = true}, [&] {
      const std::vector<MergedSurfel>& surfels = levels[level].surfels;
      for (const MergedFrom& from : levels[level + 1].from) {
        if (!from.pair()) continue;
        sequence_.surfels.push_back(surfels[from.first]);
        sequence_.surfels.push_back(surfels[from.second]);
      }
    });
  }
  void put_all(const MergedLevel& level) {
    sequence_.surfels.insert(sequence_.surfels.end(), level.surfels.begin(), level.surfels.end());
  }
  void put_singles(const Ladder& levels) {
    for (const MergedFrom& from : levels[1].from) {
      if (!from.pair()) sequence_.surfels.push_back(levels[0].surfels[from.first]);
    }
  }

  std::span<const Ladder> ladders_;
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
  const size_t count = surfels.size();
  const std::vector<Ladder> ladders = ladders_of(std::move(surfels), oriented);
  SurfelSequence sequence = Sequencer(ladders, count).sequence();
  note_radii(sequence);
  return sequence;
}

}  // namespace surfcast::residency
