#include "worker/blame.h"

namespace surfcast::worker {

std::vector<BoardBlock> Blame::worker_ended(std::span<const BoardBlock> loading) {
  const std::lock_guard lock(mutex_);
  std::vector<BoardBlock> quarantined;
  for (const BoardBlock& block : loading) {
    if (++ends_[block.model][block.block] == 2) quarantined.push_back(block);
  }
  return quarantined;
}

void Blame::forget(uint64_t model) {
  const std::lock_guard lock(mutex_);
  ends_.erase(model);
}

std::vector<uint32_t> Blame::with(uint64_t model, uint32_t least, uint32_t most) const {
  const std::lock_guard lock(mutex_);
  std::vector<uint32_t> blocks;
  const auto found = ends_.find(model);
  if (found == ends_.end()) return blocks;
  for (const auto& [block, ends] : found->second) {
    if (ends >= least && ends <= most) blocks.push_back(block);
  }
  return blocks;
}

}  // namespace surfcast::worker
