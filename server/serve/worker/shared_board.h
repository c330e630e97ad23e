#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/descriptor.h"
#include "base/result.h"

namespace surfcast::worker {

/// Pictures that can be drawn in the middle of each other, the outermost one counted.
inline constexpr size_t kDeepestPictures = 4;
/// Blocks that can be loaded at the same time and are told of.
inline constexpr size_t kBoardSlots = 256;

/// A block that is being loaded.
struct BoardBlock {
  uint64_t model = 0;
  uint32_t block = 0;
  bool operator==(const BoardBlock&) const = default;
};

/// Memory that the server and a worker share. The server makes it, with a size that can never change, so that no
/// access of the server can fail. It holds the pixels of one picture, flags that cancel pictures, and the blocks that
/// the worker is loading, which the server reads after the worker has ended.
class SharedBoard {
 public:
  /// Room for pictures of so many bytes.
  static Result<SharedBoard> create(size_t pixel_bytes);
  /// The memory that another process has made.
  static Result<SharedBoard> adopt(Descriptor memory);

  SharedBoard(SharedBoard&& other) noexcept
      : memory_(std::move(other.memory_)),
        size_(std::exchange(other.size_, 0)),
        head_(std::exchange(other.head_, nullptr)) {}
  SharedBoard& operator=(SharedBoard&& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(size_, other.size_);
    std::swap(head_, other.head_);
    return *this;
  }
  SharedBoard(const SharedBoard&) = delete;
  SharedBoard& operator=(const SharedBoard&) = delete;
  ~SharedBoard();

  [[nodiscard]] const Descriptor& memory() const { return memory_; }
  [[nodiscard]] std::span<std::byte> pixels() const;
  /// Gives pages of a large picture back to the system.
  void release_pixels(size_t bytes) const;
  /// Asks the worker to end the picture at this depth, 0 for the outermost.
  [[nodiscard]] std::atomic<bool>& cancelled(size_t depth) const { return head_->cancelled.at(depth); }

  /// Counts up as a query worker gets on.
  [[nodiscard]] std::atomic<uint64_t>& progress() const { return head_->progress; }

  /// Notes a block that this thread begins to load, and returns its slot; kBoardSlots if none is free.
  [[nodiscard]] size_t note(const BoardBlock& block) const;
  void clear(size_t slot) const;
  /// The blocks that are being loaded.
  [[nodiscard]] std::vector<BoardBlock> loading() const;

 private:
  struct Slot {
    std::atomic<bool> taken;
    std::atomic<bool> filled;
    std::atomic<uint64_t> model;
    std::atomic<uint32_t> block;
  };
  struct Head {
    std::array<std::atomic<bool>, kDeepestPictures> cancelled;
    std::atomic<uint64_t> progress;
    std::array<Slot, kBoardSlots> slots;
  };
  static_assert(std::atomic<uint64_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

  SharedBoard(Descriptor memory, size_t size, void* address)
      : memory_(std::move(memory)), size_(size), head_(static_cast<Head*>(address)) {}
  static Result<SharedBoard> map(Descriptor memory, size_t size);

  Descriptor memory_;
  size_t size_ = 0;
  Head* head_ = nullptr;
};

}  // namespace surfcast::worker
