#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>

#include "residency/block_source.h"

namespace surfcast {

/// Packed blocks in host memory, within a budget of bytes: those that left the GPU come back without being decoded
/// again. The one used least recently goes first. Not thread-safe.
class PackedCache {
 public:
  explicit PackedCache(size_t budget_bytes) : budget_(budget_bytes) {}

  /// Null if it is not here.
  std::shared_ptr<const PackedBlock> find(const BlockId& id);
  void put(const BlockId& id, std::shared_ptr<const PackedBlock> block);
  void forget(uint64_t model);
  [[nodiscard]] size_t bytes() const { return bytes_; }

 private:
  struct Entry {
    BlockId id;
    std::shared_ptr<const PackedBlock> block;
  };
  using Order = std::list<Entry>;

  void erase(std::map<BlockId, Order::iterator>::iterator found);

  size_t budget_;
  size_t bytes_ = 0;
  Order order_;  ///< most recently used first
  std::map<BlockId, Order::iterator> entries_;
};

}  // namespace surfcast
