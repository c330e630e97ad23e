#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "residency/residency.h"
#include "selection/trees.h"

namespace surfcast::testing {

/// Blocks whose first surfel contains their number. Loading can be blocked, and blocks can be damaged.
class FakeBlocks : public residency::BlockSource {
 public:
  FakeBlocks(uint64_t id, std::vector<ldc::BlockEntry> blocks) : id_(id), tree_(std::move(blocks)) {}

  [[nodiscard]] uint64_t id() const override { return id_; }
  [[nodiscard]] const ldc::BlockTree& tree() const override { return tree_; }
  void prefetch(std::span<const uint32_t> blocks) const override {
    prefetched_.insert(prefetched_.end(), blocks.begin(), blocks.end());
  }
  void forget(uint32_t block) const override { forgotten_.push_back(block); }
  [[nodiscard]] Result<residency::PackedBlock> load(uint32_t block, bool attributes) const override {
    {
      std::unique_lock lock(mutex_);
      started_.push_back(block);
      wake_.notify_all();
      wake_.wait(lock, [this] { return !held_; });
    }
    if (damaged_.contains(block)) return fail(ErrorKind::kInvalidInput, "block " + std::to_string(block) + ": damaged");
    residency::PackedBlock packed;
    packed.texels.assign(tree_.blocks()[block].items, glm::uvec4(block));
    if (attributes) packed.attributes.assign(packed.texels.size(), block);
    return packed;
  }

  [[nodiscard]] uint64_t unit_of(uint32_t block) const override { return block / unit_; }
  /// From now on so many blocks are made together. Must be called before the blocks are given to a loader.
  void make_together(uint32_t blocks) { unit_ = blocks; }

  void damage(uint32_t block) { damaged_.insert(block); }
  /// From now on load() does not return until release().
  void hold() { set_held(true); }
  void release() { set_held(false); }
  /// Waits until the loading of this many blocks has started.
  void wait_for_start(size_t blocks) const {
    std::unique_lock lock(mutex_);
    wake_.wait(lock, [&] { return started_.size() >= blocks; });
  }
  /// The blocks in the order in which their loading started.
  [[nodiscard]] std::vector<uint32_t> started() const {
    const std::lock_guard lock(mutex_);
    return started_;
  }
  /// The prefetched blocks, in order. Must be called by the thread that calls the loader.
  [[nodiscard]] const std::vector<uint32_t>& prefetched() const { return prefetched_; }
  /// The blocks that are not announced any more, likewise.
  [[nodiscard]] const std::vector<uint32_t>& forgotten() const { return forgotten_; }

 private:
  void set_held(bool held) {
    {
      const std::lock_guard lock(mutex_);
      held_ = held;
    }
    wake_.notify_all();
  }

  uint64_t id_;
  ldc::BlockTree tree_;
  std::set<uint32_t> damaged_;
  mutable std::mutex mutex_;
  mutable std::condition_variable wake_;
  mutable std::vector<uint32_t> started_;
  mutable std::vector<uint32_t> prefetched_;
  mutable std::vector<uint32_t> forgotten_;
  bool held_ = false;
  uint32_t unit_ = 1;
};

/// Stores the texels that a pool writes.
class FakeSink : public residency::TexelSink {
 public:
  void write(size_t first, std::span<const glm::uvec4> surfels) override {
    for (size_t i = 0; i < surfels.size(); ++i) texels_[first + i] = surfels[i].x;
    written_ += surfels.size_bytes();
  }
  void write_attributes(size_t first, std::span<const uint32_t> attributes) override {
    for (size_t i = 0; i < attributes.size(); ++i) attributes_[first + i] = attributes[i];
  }
  [[nodiscard]] uint32_t at(size_t texel) const { return texels_.at(texel); }
  [[nodiscard]] uint32_t attribute_at(size_t texel) const { return attributes_.at(texel); }
  [[nodiscard]] size_t written() const { return written_; }

 private:
  std::map<size_t, uint32_t> texels_;
  std::map<size_t, uint32_t> attributes_;
  size_t written_ = 0;
};

}  // namespace surfcast::testing
