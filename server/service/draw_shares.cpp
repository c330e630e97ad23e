#include "service/draw_shares.h"

#include <algorithm>

namespace surfcast::service {
namespace {

constexpr double kShare = 0.25;
// What either side may be behind at most: a motion is not held up for longer because a picture of it was expensive, nor
// may it keep the thread for long because others were alone before.
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
