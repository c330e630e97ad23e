#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <span>
#include <vector>

#include "residency/block_source.h"

namespace surfcast::residency {

/// Who has which pages of a memory of equal pages. A block takes as many as it needs, wherever they are; the blocks
/// used least recently give theirs up. What has been used since the last begin_frame() and what is pinned stays. A
/// frame may be interrupted by a nested frame, with frames of its own: what it used before and uses after it stays
/// through all of them.
class PageTable {
 public:
  explicit PageTable(uint32_t pages) : pages_(pages) {}

  /// Forgets which blocks are in use.
  void begin_frame();
  void begin_nested_frame() { in_nested_frame_ = true; }
  void end_nested_frame();
  /// The block is in use until the next frame.
  void use(const BlockId& id);
  /// The block stays until its model is forgotten.
  void pin(const BlockId& id);

  /// The pages of a block; empty if it has none.
  [[nodiscard]] std::span<const uint32_t> find(const BlockId& id) const;
  /// Gives a block, which has none, `count` pages (at least 1) and takes it for used. `evicted` is told which blocks
  /// lose theirs. Empty, and nothing changes, when blocks in use leave too few.
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
    uint64_t last_outer = 0;  ///< frame that was no nested frame
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
  uint64_t outer_frame_ = 1;  ///< the newest that is no nested frame
  bool in_nested_frame_ = false;
  uint32_t used_ = 0;
  uint32_t pinned_ = 0;
  uint32_t untouched_ = 0;      ///< pages from here on have never been used
  std::vector<uint32_t> free_;  ///< used once, free again
  Entries entries_;
  std::list<BlockId> order_;  ///< most recently used first
};

}  // namespace surfcast::residency
