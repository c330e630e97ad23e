#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <vector>

#include "base/lru_cache.h"
#include "residency/block_source.h"

namespace surfcast::residency {

/// A block that was wanted, or why it cannot be had.
struct LoadedBlock {
  BlockId id;
  Result<std::shared_ptr<const PackedBlock>> block;
  double milliseconds = 0;  ///< of a worker's time; 0 when it was still in host memory
};

struct LoaderLimits {
  unsigned threads = 1;
  unsigned idle_threads = 0;  ///< besides, for what is not wanted yet, in time that the processor is idle
  size_t cache_bytes =
      0;  ///< packed blocks kept in host memory, those that left the GPU come back without being decoded again
  size_t ready_bytes = 0;  ///< loaded blocks that wait to be taken before the workers wait, too
};

/// Worker threads that read, decode and pack blocks for one other thread, which alone calls the methods. They work on
/// the newest list of requests only: what is not on it any more is dropped before it is decoded. Some work only when
/// the processor has nothing else to do, on what may be wanted soon, and leave it in host memory.
class BlockLoader {
 public:
  explicit BlockLoader(const LoaderLimits& limits);
  ~BlockLoader();
  BlockLoader(const BlockLoader&) = delete;
  BlockLoader& operator=(const BlockLoader&) = delete;

  /// Replaces the requests, most urgent first, all with attributes or all without. Blocks being decoded at the moment
  /// are finished and, if nobody wants them, kept in host memory.
  void set_requests(const std::shared_ptr<const BlockSource>& source, std::span<const uint32_t> blocks,
                    bool attributes = false);
  /// Replaces what may be wanted soon, most urgent first; of it as much as half of the host memory for blocks holds.
  void prefetch(const std::shared_ptr<const BlockSource>& source, std::span<const uint32_t> blocks, bool attributes);
  /// The next requested block that has been loaded; its request is then done.
  std::optional<LoadedBlock> take();
  /// Waits until take() has something, at most so long.
  void wait(std::chrono::milliseconds most);
  void release_model(uint64_t model);

 private:
  struct Request {
    std::shared_ptr<const BlockSource> source;
    BlockId id;
  };

  void work();
  void work_on_prefetches();
  [[nodiscard]] LoadedBlock load(const Request& request, std::unique_lock<std::mutex>& lock);
  void keep(const LoadedBlock& loaded);
  void finish(LoadedBlock loaded);
  void make_ready(LoadedBlock loaded);
  void drop_unwanted();

  const LoaderLimits limits_;
  std::mutex mutex_;  ///< guards what follows
  std::condition_variable wake_workers_;
  std::condition_variable wake_prefetchers_;
  std::condition_variable wake_taker_;
  std::deque<Request> queue_;
  std::deque<Request> prefetch_queue_;  ///< what may be wanted soon
  std::set<BlockId> prefetching_;       ///< of it, being decoded
  std::set<BlockId> damaged_prefetches_;
  std::set<BlockId> requested_;  ///< the requests that have not been taken
  std::set<BlockId> busy_;       ///< being decoded
  std::deque<LoadedBlock> ready_;
  size_t ready_bytes_ = 0;
  LruCache<BlockId, PackedBlock> cache_;
  bool stopping_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace surfcast::residency
