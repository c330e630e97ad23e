#include "residency/packed_cache.h"

#include <utility>

namespace surfcast {

std::shared_ptr<const PackedBlock> PackedCache::find(const BlockId& id) {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return nullptr;
  order_.splice(order_.begin(), order_, found->second);
  return found->second->block;
}

void PackedCache::put(const BlockId& id, std::shared_ptr<const PackedBlock> block) {
  if (find(id)) return;
  bytes_ += block->bytes();
  order_.push_front({id, std::move(block)});
  entries_[id] = order_.begin();
  while (bytes_ > budget_) erase(entries_.find(order_.back().id));
}

void PackedCache::forget(uint64_t model) {
  for (auto entry = entries_.lower_bound({model, 0}); entry != entries_.end() && entry->first.model == model;) {
    erase(entry++);
  }
}

void PackedCache::erase(std::map<BlockId, Order::iterator>::iterator found) {
  bytes_ -= found->second->block->bytes();
  order_.erase(found->second);
  entries_.erase(found);
}

}  // namespace surfcast
