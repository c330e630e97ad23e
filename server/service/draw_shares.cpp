#include "service/draw_shares.h"

#include <algorithm>

namespace surfcast::service {
namespace {

constexpr double kShare = 0.25;
// The most time by which either side may fall behind its share. One expensive motion picture does not delay the motion
// for longer, and a phase without motion does not let it occupy the thread for longer.
constexpr double kMaxMs = 60;

}  // namespace

void DrawShares::drew_motion(double milliseconds, bool others_wait) {
  if (!others_wait) return;
  owed_ms_ = std::min(owed_ms_ + milliseconds * kShare / (1 - kShare), kMaxMs);
}

void DrawShares::drew_other(double milliseconds) {
  owed_ms_ = std::max(owed_ms_ - milliseconds, -kMaxMs);
}

}  // namespace surfcast::service
