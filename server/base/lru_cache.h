#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <utility>

namespace surfcast {

/// Values within a budget of bytes; the one used least recently goes first. Not thread-safe.
template <typename Key, typename Value>
class LruCache {
 public:
  explicit LruCache(size_t budget_bytes) : budget_(budget_bytes) {}

  /// Null if it is not here.
  std::shared_ptr<const Value> find(const Key& key) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return nullptr;
    order_.splice(order_.begin(), order_, found->second);
    return found->second->value;
  }

  /// Keeps a value that takes so many bytes, unless there is one of that key.
  void put(const Key& key, std::shared_ptr<const Value> value, size_t bytes) {
    if (find(key)) return;
    bytes_ += bytes;
    order_.push_front({key, std::move(value), bytes});
    entries_[key] = order_.begin();
    while (bytes_ > budget_) erase(entries_.find(order_.back().key));
  }

  /// Forgets the keys from `first` on to before `last`.
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
