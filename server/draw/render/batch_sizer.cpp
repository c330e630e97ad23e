#include "render/batch_sizer.h"

#include <algorithm>
#include <utility>

namespace surfcast::render {
namespace {

constexpr double kBatchMs = 8;
constexpr double kMaxGrowth = 4;      // of the batch size in one step, because the cost of groups varies
constexpr size_t kMaxGroups = 32768;  // OpenGL guarantees 65535 along a dimension

}  // namespace

void BatchSizer::begin_pass() {
  groups_ = first_;
  begins_ = true;
}

void BatchSizer::record(size_t groups, double milliseconds) {
  if (groups == 0) return;
  const double fitting = static_cast<double>(groups) * kBatchMs / std::max(milliseconds, 1e-3);
  // The last batch of a pass may have few groups, whose rate says little about larger batches.
  const double most = kMaxGrowth * static_cast<double>(std::max(groups, groups_));
  groups_ = std::clamp(static_cast<size_t>(std::min(fitting, most)), size_t{1}, kMaxGroups);
  if (std::exchange(begins_, false)) first_ = groups_;
}

}  // namespace surfcast::render
