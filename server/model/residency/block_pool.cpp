#include "residency/block_pool.h"

#include <algorithm>

#include "base/contract.h"

namespace surfcast::residency {

void BlockPool::pin(const BlockId& id) {
  constexpr uint32_t kPinnedShare = 8;
  const size_t more = table_.find(id).size();
  if (table_.pinned_pages() + more <= table_.pages() / kPinnedShare) table_.pin(id);
}

namespace {

/// Calls `write(first texel in memory, first texel of the block, count)` for each run of contiguous pages.
template <typename Write>
void for_each_run(std::span<const uint32_t> pages, size_t texels, const Write& write) {
  for (size_t i = 0; i < pages.size();) {
    size_t end = i + 1;
    while (end < pages.size() && pages[end] == pages[end - 1] + 1) ++end;
    const size_t first = i * BlockPool::kPageTexels;
    const size_t last = std::min(end * BlockPool::kPageTexels, texels);
    write(size_t{pages[i]} * BlockPool::kPageTexels, first, last - first);
    i = end;
  }
}

}  // namespace

/// Removes a block that loses its pages.
void BlockPool::drop(const BlockId& id) {
  const auto found = blocks_.find(id);
  if (found->second.intensity) attribute_pages_ -= found->second.pages.size();
  blocks_.erase(found);
  Residents& residents = residents_[id.model];
  residents.surfels[id.block] = false;
  residents.attributes[id.block] = false;
}

/// Assigns pages to a block and writes its texels; null if there is no room.
ResidentBlock* BlockPool::place(const BlockId& id, const ldc::BlockTree& tree, const PackedBlock& block) {
  const auto texels = static_cast<uint32_t>(block.texels.size());
  const uint32_t count = std::max(1U, (texels + kPageTexels - 1) / kPageTexels);  // a block may be empty
  const std::span<const uint32_t> pages = table_.insert(id, count, [this](const BlockId& evicted) { drop(evicted); });
  if (pages.empty()) return nullptr;
  for_each_run(pages, texels, [&](size_t texel, size_t first, size_t run) {
    sink_.write(texel, std::span(block.texels).subspan(first, run));
  });
  Residents& residents = residents_[id.model];
  residents.surfels.resize(tree.blocks().size());
  residents.attributes.resize(tree.blocks().size());
  residents.surfels[id.block] = true;
  return &(blocks_[id] = {block.lattice, block.header, std::nullopt, pages});
}

void BlockPool::add_attributes(const BlockId& id, const PackedBlock& block, ResidentBlock& resident) {
  for_each_run(resident.pages, block.attributes.size(), [&](size_t texel, size_t first, size_t run) {
    sink_.write_attributes(texel, std::span(block.attributes).subspan(first, run));
  });
  if (!resident.intensity) attribute_pages_ += resident.pages.size();
  resident.intensity = block.intensity;
  residents_[id.model].attributes[id.block] = true;
}

bool BlockPool::store(const BlockId& loaded, const ldc::BlockTree& tree, const PackedBlock& block) {
  const BlockId id = loaded.without_attributes();
  const auto found = blocks_.find(id);
  ResidentBlock* resident = found == blocks_.end() ? place(id, tree, block) : &found->second;
  if (resident == nullptr) return false;
  table_.use(id);
  if (loaded.attributes) add_attributes(id, block, *resident);
  return true;
}

const std::vector<bool>& BlockPool::residents(uint64_t model, bool attributes) const {
  static const std::vector<bool> kNone;
  const auto found = residents_.find(model);
  if (found == residents_.end()) return kNone;
  return attributes ? found->second.attributes : found->second.surfels;
}

const ResidentBlock& BlockPool::at(const BlockId& id) const {
  const auto found = blocks_.find(id);
  SURFCAST_EXPECTS(found != blocks_.end());
  return found->second;
}

void BlockPool::release_model(uint64_t model) {
  table_.release_model(model);
  const auto end = blocks_.lower_bound({model + 1, 0});
  for (auto block = blocks_.lower_bound({model, 0}); block != end; block = blocks_.erase(block)) {
    if (block->second.intensity) attribute_pages_ -= block->second.pages.size();
  }
  residents_.erase(model);
}

}  // namespace surfcast::residency
