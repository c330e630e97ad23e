#pragma once

#include <array>
#include <cstddef>
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
/// begin_frame() and may be preempted as well. Blocks that a frame uses before or after a nested one stay until it
/// ends.
class PageTable {
 public:
  static constexpr size_t kMaxNested = 2;

  explicit PageTable(uint32_t pages) : pages_(pages) {}

  /// Starts a frame: no block is in use.
  void begin_frame();
  /// At most kMaxNested frames deep.
  void begin_nested_frame();
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
  using Frames = std::array<uint64_t, kMaxNested + 1>;  ///< numbers of frames by depth, the outermost first

  struct Entry {
    std::vector<uint32_t> pages;
    Frames last{};  ///< the last frame of each depth that used the block
    bool pinned = false;
    std::list<BlockId>::iterator order;
  };
  using Entries = std::map<BlockId, Entry>;

  void touch(Entry& entry) const;
  [[nodiscard]] bool evictable(const Entry& entry) const;
  [[nodiscard]] bool can_free(uint32_t count) const;
  Entries::iterator release(Entries::iterator entry);
  uint32_t take_page();

  uint32_t pages_;
  uint64_t frame_ = 1;  ///< number of the newest frame
  Frames begun_{1};     ///< the frames that are being drawn
  size_t depth_ = 0;    ///< of the newest of them
  uint32_t used_ = 0;
  uint32_t pinned_ = 0;
  uint32_t untouched_ = 0;      ///< pages from this one on have never been used
  std::vector<uint32_t> free_;  ///< used earlier, free again
  Entries entries_;
  std::list<BlockId> order_;  ///< most recently used first
};

}  // namespace surfcast::residency
