#include "render/batch_pace.h"

#include <algorithm>

namespace surfcast {
namespace {

constexpr double kBatchMs = 8;
constexpr double kMostGrowth = 4;      // of one batch against the one before: groups differ in what they cost
constexpr size_t kMostGroups = 32768;  // GL promises 65535 along a dimension

}  // namespace

void BatchPace::took(size_t groups, double milliseconds) {
  if (groups == 0) return;
  const double fitting = static_cast<double>(groups) * kBatchMs / std::max(milliseconds, 1e-3);
  // A last batch with few groups says how fast they are, but not that more would be as fast.
  const double most = kMostGrowth * static_cast<double>(std::max(groups, groups_));
  groups_ = std::clamp(static_cast<size_t>(std::min(fitting, most)), size_t{1}, kMostGroups);
}

}  // namespace surfcast
