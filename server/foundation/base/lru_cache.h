#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <utility>

namespace surfcast {

/// A cache with a budget in bytes that evicts the least recently used value first. Not thread-safe.
template <typename Key, typename Value>
class LruCache {
 public:
  explicit LruCache(size_t budget_bytes) : budget_(budget_bytes) {}

  /// Null if the cache does not hold the key. Marks the entry as most recently used.
  std::shared_ptr<const Value> find(const Key& key) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return nullptr;
    order_.splice(order_.begin(), order_, found->second);
    return found->second->value;
  }

  /// Adds a value of the given size, unless the key is present. Evicts others, or the value itself if it exceeds the
  /// budget.
  void put(const Key& key, std::shared_ptr<const Value> value, size_t bytes) {
    if (find(key)) return;
    bytes_ += bytes;
    order_.push_front({key, std::move(value), bytes});
    entries_[key] = order_.begin();
    while (bytes_ > budget_) erase(entries_.find(order_.back().key));
  }

  /// Removes all keys in [first, last).
  void erase_range(const Key& first, const Key& last) {
    const auto end = entries_.lower_bound(last);
    for (auto entry = entries_.lower_bound(first); entry != end;) erase(entry++);
  }

 private:
  struct Entry {
    Key key;
    std::shared_ptr<const Value> value;
    size_t bytes = 0;
  };
  using Order = std::list<Entry>;

  void erase(typename std::map<Key, typename Order::iterator>::iterator found) {
    bytes_ -= found->second->bytes;
    order_.erase(found->second);
    entries_.erase(found);
  }

  size_t budget_;
  size_t bytes_ = 0;
  Order order_;  ///< most recently used first
  std::map<Key, typename Order::iterator> entries_;
};

}  // namespace surfcast
