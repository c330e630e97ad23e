#include "service/draw_shares.h"

#include <algorithm>

namespace surfcast::service {
namespace {

constexpr double kSmallShare = 0.5;
constexpr double kLargeShare = 0.25;
// The most time by which either side may fall behind its share. One expensive motion picture does not delay the motion
// for longer, and a phase without motion does not let it occupy the thread for longer. Small still pictures are owed as
// much as the last motion picture took, because otherwise pictures longer than this would leave them less than a half.
constexpr double kMaxMs = 60;

}  // namespace

void DrawShares::drew_motion(double milliseconds, WaitingStills stills) {
  if (stills == WaitingStills::kNone) return;
  const bool small = stills == WaitingStills::kSmall;
  const double share = small ? kSmallShare : kLargeShare;
  const double owed_now = milliseconds * share / (1 - share);
  owed_ms_ = std::min(owed_ms_ + owed_now, small ? std::max(owed_now, kMaxMs) : kMaxMs);
}

void DrawShares::drew_other(double milliseconds) {
  owed_ms_ = std::max(owed_ms_ - milliseconds, -kMaxMs);
}

}  // namespace surfcast::service
