#pragma once

#include <cstddef>
#include <span>

namespace surfcast {

/// Zero-initialised memory that the operating system backs page by page, on the first write to each page.
class LazyMemory {
 public:
  LazyMemory() = default;
  /// Reserves address space. `bytes()` is empty if the operating system refuses.
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
