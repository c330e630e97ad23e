#include "residency/surfel_pool.h"

#include <algorithm>

#include "base/contract.h"

namespace surfcast {

void SurfelPool::pin(const BlockId& id) {
  constexpr uint32_t kPinnedShare = 8;
  const size_t more = table_.find(id).size();
  if (table_.pinned_pages() + more <= table_.pages() / kPinnedShare) table_.pin(id);
}

bool SurfelPool::store(const BlockId& id, const BlockTree& tree, const PackedBlock& block) {
  const auto surfels = static_cast<uint32_t>(block.surfels.size());
  const uint32_t count = (surfels + kPageSurfels - 1) / kPageSurfels;
  const std::span<const uint32_t> pages = table_.insert(id, count, [this](const BlockId& evicted) {
    blocks_.erase(evicted);
    residents_[evicted.model][evicted.block] = false;
  });
  if (pages.empty()) return false;
  write(pages, block.surfels);
  blocks_[id] = {block.origin, block.step, block.radius, block.weight, surfels, pages};
  std::vector<bool>& residents = residents_[id.model];
  residents.resize(tree.blocks().size());
  residents[id.block] = true;
  return true;
}

/// Pages that follow each other are written at once.
void SurfelPool::write(std::span<const uint32_t> pages, std::span<const glm::uvec4> surfels) {
  for (size_t i = 0; i < pages.size();) {
    size_t end = i + 1;
    while (end < pages.size() && pages[end] == pages[end - 1] + 1) ++end;
    const size_t first = i * kPageSurfels;
    const size_t last = std::min(end * kPageSurfels, surfels.size());
    sink_.write(size_t{pages[i]} * kPageSurfels, surfels.subspan(first, last - first));
    i = end;
  }
}

const std::vector<bool>& SurfelPool::residents(uint64_t model) const {
  static const std::vector<bool> kNone;
  const auto found = residents_.find(model);
  return found == residents_.end() ? kNone : found->second;
}

ResidentBlock SurfelPool::at(const BlockId& id) const {
  const auto found = blocks_.find(id);
  SURFCAST_EXPECTS(found != blocks_.end());
  return found->second;
}

void SurfelPool::forget(uint64_t model) {
  table_.forget(model);
  blocks_.erase(blocks_.lower_bound({model, 0}), blocks_.lower_bound({model + 1, 0}));
  residents_.erase(model);
}

}  // namespace surfcast
