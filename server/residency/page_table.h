#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <span>
#include <vector>

#include "residency/block_source.h"

namespace surfcast::residency {

/// Assigns the pages of a memory of equal pages to blocks. A block takes as many pages as it needs; they need not be
/// contiguous. If pages run short, the least recently used blocks are evicted. Blocks that were used since the last
/// begin_frame() and pinned blocks are never evicted. A frame may be preempted by a nested frame, which has its own
/// begin_frame(). Blocks that the outer frame uses before or after the nested one stay until the outer frame ends.
class PageTable {
 public:
  explicit PageTable(uint32_t pages) : pages_(pages) {}

  /// Starts a frame: no block is in use.
  void begin_frame();
  void begin_nested_frame() { in_nested_frame_ = true; }
  void end_nested_frame();
  /// The block is in use until the next frame.
  void use(const BlockId& id);
  /// The block stays until its model is released.
  void pin(const BlockId& id);

  /// The pages of a block; empty if it has none.
  [[nodiscard]] std::span<const uint32_t> find(const BlockId& id) const;
  /// Assigns `count` pages (at least 1) to a block that has none, and marks it as used. `evicted` is called for each
  /// block that loses its pages. If the blocks in use leave too few pages, changes nothing and returns an empty span.
  std::span<const uint32_t> insert(const BlockId& id, uint32_t count,
                                   const std::function<void(const BlockId&)>& evicted);
  void release_model(uint64_t model);

  [[nodiscard]] uint32_t pages() const { return pages_; }
  [[nodiscard]] uint32_t pinned_pages() const { return pinned_; }
  [[nodiscard]] uint32_t used_pages() const { return used_; }
  [[nodiscard]] size_t blocks() const { return entries_.size(); }

 private:
  struct Entry {
    std::vector<uint32_t> pages;
    uint64_t last_frame = 0;
    uint64_t last_outer = 0;  ///< the last outer frame that used the block
    bool pinned = false;
    std::list<BlockId>::iterator order;
  };
  using Entries = std::map<BlockId, Entry>;

  void touch(Entry& entry) const;
  [[nodiscard]] bool evictable(const Entry& entry) const {
    return !entry.pinned && entry.last_frame < frame_ && entry.last_outer < outer_frame_;
  }
  [[nodiscard]] bool can_free(uint32_t count) const;
  Entries::iterator release(Entries::iterator entry);
  uint32_t take_page();

  uint32_t pages_;
  uint64_t frame_ = 1;        ///< the newest
  uint64_t outer_frame_ = 1;  ///< the newest outer frame
  bool in_nested_frame_ = false;
  uint32_t used_ = 0;
  uint32_t pinned_ = 0;
  uint32_t untouched_ = 0;      ///< pages from this one on have never been used
  std::vector<uint32_t> free_;  ///< used earlier, free again
  Entries entries_;
  std::list<BlockId> order_;  ///< most recently used first
};

}  // namespace surfcast::residency
