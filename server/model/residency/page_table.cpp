#include "residency/page_table.h"

#include <limits>

#include "base/contract.h"

namespace surfcast::residency {

void PageTable::begin_frame() {
  begun_.at(depth_) = ++frame_;
}

void PageTable::begin_nested_frame() {
  SURFCAST_EXPECTS(depth_ < kMaxNested);
  begun_.at(++depth_) = ++frame_;
}

void PageTable::end_nested_frame() {
  SURFCAST_EXPECTS(depth_ > 0);
  --depth_;
}

void PageTable::touch(Entry& entry) const {
  entry.last.at(depth_) = begun_.at(depth_);
}

bool PageTable::evictable(const Entry& entry) const {
  if (entry.pinned) return false;
  for (size_t depth = 0; depth <= depth_; ++depth) {
    if (entry.last.at(depth) == begun_.at(depth)) return false;
  }
  return true;
}

void PageTable::use(const BlockId& id) {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return;
  touch(found->second);
  order_.splice(order_.begin(), order_, found->second.order);
}

void PageTable::pin(const BlockId& id) {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.pinned) return;
  found->second.pinned = true;
  pinned_ += static_cast<uint32_t>(found->second.pages.size());
}

std::span<const uint32_t> PageTable::find(const BlockId& id) const {
  const auto found = entries_.find(id);
  return found == entries_.end() ? std::span<const uint32_t>() : found->second.pages;
}

bool PageTable::can_free(uint32_t count) const {
  uint32_t available = pages_ - used_;
  for (auto id = order_.rbegin(); id != order_.rend() && available < count; ++id) {
    const Entry& entry = entries_.at(*id);
    if (evictable(entry)) available += static_cast<uint32_t>(entry.pages.size());
  }
  return available >= count;
}

PageTable::Entries::iterator PageTable::release(Entries::iterator entry) {
  const auto count = static_cast<uint32_t>(entry->second.pages.size());
  free_.insert(free_.end(), entry->second.pages.begin(), entry->second.pages.end());
  used_ -= count;
  if (entry->second.pinned) pinned_ -= count;
  order_.erase(entry->second.order);
  return entries_.erase(entry);
}

uint32_t PageTable::take_page() {
  ++used_;
  if (free_.empty()) return untouched_++;
  const uint32_t page = free_.back();
  free_.pop_back();
  return page;
}

std::span<const uint32_t> PageTable::insert(const BlockId& id, uint32_t count,
                                            const std::function<void(const BlockId&)>& evicted) {
  SURFCAST_EXPECTS(count > 0 && !entries_.contains(id));
  if (!can_free(count)) return {};
  for (auto last = order_.end(); pages_ - used_ < count;) {
    --last;
    const auto entry = entries_.find(*last);
    if (!evictable(entry->second)) continue;
    evicted(*last);
    ++last;  // release() removes the preceding element from the list
    release(entry);
  }
  order_.push_front(id);
  Entry entry{.pages = {}, .order = order_.begin()};
  touch(entry);
  for (uint32_t i = 0; i < count; ++i) entry.pages.push_back(take_page());
  return entries_.emplace(id, std::move(entry)).first->second.pages;
}

void PageTable::release_model(uint64_t model) {
  auto entry = entries_.lower_bound({model, 0});
  while (entry != entries_.end() && entry->first.model == model) entry = release(entry);
}

}  // namespace surfcast::residency
