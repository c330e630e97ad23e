#include "render/batch_sizer.h"

#include <algorithm>

namespace surfcast::render {
namespace {

constexpr double kBatchMs = 8;
constexpr double kMaxGrowth = 4;      // of one batch against the one before: groups differ in what they cost
constexpr size_t kMaxGroups = 32768;  // GL promises 65535 along a dimension

}  // namespace

void BatchSizer::record(size_t groups, double milliseconds) {
  if (groups == 0) return;
  const double fitting = static_cast<double>(groups) * kBatchMs / std::max(milliseconds, 1e-3);
  // A last batch with few groups says how fast they are, but not that more would be as fast.
  const double most = kMaxGrowth * static_cast<double>(std::max(groups, groups_));
  groups_ = std::clamp(static_cast<size_t>(std::min(fitting, most)), size_t{1}, kMaxGroups);
}

}  // namespace surfcast::render
