#pragma once

#include <cstddef>
#include <span>

namespace surfcast {

/// Memory of which only the pages that have been written are taken from the machine. Zero at first.
class LazyMemory {
 public:
  LazyMemory() = default;
  /// Empty where the machine does not lend so much.
  explicit LazyMemory(size_t bytes);
  LazyMemory(LazyMemory&& other) noexcept;
  LazyMemory& operator=(LazyMemory&& other) noexcept;
  LazyMemory(const LazyMemory&) = delete;
  LazyMemory& operator=(const LazyMemory&) = delete;
  ~LazyMemory();

  [[nodiscard]] std::span<std::byte> bytes() const { return {static_cast<std::byte*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace surfcast
