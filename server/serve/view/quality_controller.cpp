#include "view/quality_controller.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

namespace surfcast::view {
namespace {

/// A setting and its cost relative to the other rungs of its ladder.
struct DrawRung {
  double scale = 1;
  double spacing = 1;
  double cost = 1;
};
struct LinkRung {
  double scale = 1;
  int jpeg_quality = 80;
  double cost = 1;
};

// The cost of splats is proportional to their number, which falls with the square of the spacing; that of pixels to
// their number. With software rendering, where this matters, and a spacing of one pixel, the splats take ten times as
// long as the pixels (docs/laboratory.md).
constexpr double draw_cost(double scale, double spacing) {
  constexpr double kSplats = 10.0;
  return scale * scale * (1 + kSplats / (spacing * spacing));
}

constexpr DrawRung draw_rung(double scale, double spacing) {
  return {scale, spacing, draw_cost(scale, spacing)};
}

// A smaller picture with dense surfels looks better than a large one with sparse surfels, down to half the size. Each
// rung costs a fifth to a third less than the one before, so no rung leaves much of the time unused.
constexpr std::array kDrawRungs{
    draw_rung(1, 1),       draw_rung(1, 1.2),    draw_rung(1, 1.5),      draw_rung(0.875, 1.5), draw_rung(0.75, 1.5),
    draw_rung(0.75, 1.75), draw_rung(0.75, 2),   draw_rung(0.625, 1.75), draw_rung(0.5, 1.5),   draw_rung(0.5, 1.75),
    draw_rung(0.5, 2),     draw_rung(0.4375, 2), draw_rung(0.4375, 2.5), draw_rung(0.375, 2.5), draw_rung(0.3125, 2.5),
    draw_rung(0.25, 2),    draw_rung(0.25, 2.5), draw_rung(0.25, 3)};

/// True if each rung is cheaper than the one before.
constexpr bool descends() {
  for (size_t i = 1; i < kDrawRungs.size(); ++i) {
    if (kDrawRungs[i].cost >= kDrawRungs[i - 1].cost) return false;
  }
  return true;
}
static_assert(descends());

// Relative size of the JPEG: bytes relative to quality 85, times the share of pixels.
constexpr std::array<LinkRung, 9> kLinkRungs{{{1, 85, 1.0},
                                              {1, 75, 0.75},
                                              {1, 65, 0.62},
                                              {0.75, 65, 0.38},
                                              {0.75, 50, 0.3},
                                              {0.5, 60, 0.17},
                                              {0.5, 45, 0.13},
                                              {0.375, 45, 0.08},
                                              {0.25, 45, 0.04}}};

constexpr double kFull = 0.9;     // usable share of the frame time
constexpr double kRoom = 0.9;     // a better rung is tried if its predicted time is below this share of the usable time
constexpr double kOver = 1.08;    // times the usable time: a mean above it lowers the quality
constexpr double kFarOver = 1.5;  // times the usable time: two frames in a row above it lower the quality at once
constexpr int kFramesBeforeClimb = 8;
constexpr int kMaxFramesBeforeClimb = 192;

template <typename Rung>
double predicted(std::span<const Rung> rungs, size_t from, size_t to, double ms) {
  return ms * rungs[to].cost / rungs[from].cost;
}

/// The best rung whose predicted time is within the budget, or the last rung.
template <typename Rung>
size_t affordable(std::span<const Rung> rungs, size_t from, double ms, double budget) {
  size_t rung = 0;
  while (rung + 1 < rungs.size() && predicted(rungs, from, rung, ms) > budget) ++rung;
  return rung;
}

/// The mean of the times without the largest.
double typical(const std::array<double, 8>& recent) {
  const double sum = std::accumulate(recent.begin(), recent.end(), 0.0);
  return (sum - *std::ranges::max_element(recent)) / static_cast<double>(recent.size() - 1);
}

/// Lowers the quality to what fits frames of this time, by at least one rung.
template <typename Rung>
LadderState descend(const LadderState& state, std::span<const Rung> rungs, double ms, double budget) {
  const size_t next = std::min(state.rung + 1, rungs.size() - 1);
  const bool climbed_in_vain = state.since_climb < state.frames_before_climb;
  LadderState lower;
  lower.rung = std::max(next, affordable(rungs, state.rung, ms, budget));
  if (climbed_in_vain) lower.rung = std::max(lower.rung, state.climbed_from);
  lower.frames_before_climb =
      climbed_in_vain ? std::min(2 * state.frames_before_climb, kMaxFramesBeforeClimb) : state.frames_before_climb;
  lower.since_climb = kMaxFramesBeforeClimb;
  return lower;
}

/// Raises the quality if a better rung is predicted to leave room.
template <typename Rung>
LadderState climb(const LadderState& state, std::span<const Rung> rungs, double ms, double budget) {
  if (state.rung == 0 || state.frames < state.frames_before_climb) return state;
  const size_t fits = affordable(rungs, state.rung, ms, kRoom * budget);
  if (fits >= state.rung) return state;
  LadderState higher;
  higher.rung = fits;
  higher.frames_before_climb = state.frames_before_climb;
  higher.climbed_from = state.rung;
  return higher;
}

template <typename Rung>
LadderState step(LadderState state, std::span<const Rung> rungs, double ms, double budget) {
  // A rung kept for this long was no mistake: the next raise is as easy as the first.
  if (++state.since_climb > 2 * kMaxFramesBeforeClimb) state.frames_before_climb = kFramesBeforeClimb;
  std::rotate(state.recent.begin(), state.recent.end() - 1, state.recent.end());
  state.recent.front() = ms;
  ++state.frames;
  const double last_two = state.frames >= 2 ? std::min(state.recent[0], state.recent[1]) : 0;
  if (last_two > kFarOver * budget) return descend(state, rungs, last_two, budget);
  if (static_cast<size_t>(state.frames) < state.recent.size()) return state;
  const double mean = typical(state.recent);
  return mean > kOver * budget ? descend(state, rungs, mean, budget) : climb(state, rungs, mean, budget);
}

}  // namespace

QualityState first_quality() {
  constexpr size_t kMiddle = 10;
  QualityState state;
  state.draw = {.rung = kMiddle, .since_climb = kMaxFramesBeforeClimb};
  state.link = {.rung = 2, .since_climb = kMaxFramesBeforeClimb};
  return state;
}

namespace {

double budget_of(double target_fps) {
  return kFull * 1000 / target_fps;
}

LadderState step_drawing(const LadderState& state, const MotionCost& cost, double budget) {
  return step(state, std::span<const DrawRung>(kDrawRungs), std::max({cost.draw, cost.encode, cost.client}), budget);
}

}  // namespace

QualityState adapt(const QualityState& state, const MotionCost& cost, double target_fps) {
  const double budget = budget_of(target_fps);
  return {step_drawing(state.draw, cost, budget),
          step(state.link, std::span<const LinkRung>(kLinkRungs), cost.transfer, budget)};
}

QualityState adapt_drawing(const QualityState& state, const MotionCost& cost, double target_fps) {
  return {step_drawing(state.draw, cost, budget_of(target_fps)), state.link};
}

MotionQuality quality_of(const QualityState& state) {
  const DrawRung& draw = kDrawRungs[state.draw.rung];
  const LinkRung& link = kLinkRungs[state.link.rung];
  return {std::min(draw.scale, link.scale), draw.spacing, link.jpeg_quality};
}

MotionQuality drawing_of(const QualityState& state) {
  const DrawRung& draw = kDrawRungs[state.draw.rung];
  return {draw.scale, draw.spacing, kLinkRungs.front().jpeg_quality};
}

}  // namespace surfcast::view
