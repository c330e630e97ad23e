#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <vector>

#include "base/lru_cache.h"
#include "residency/block_source.h"
#include "residency/load_guard.h"

namespace surfcast::residency {

/// A requested block, or the error of loading it.
struct LoadedBlock {
  BlockId id;
  Result<std::shared_ptr<const PackedBlock>> block;
  double milliseconds = 0;  ///< time of a worker thread; 0 if the block was in host memory
};

struct LoaderLimits {
  unsigned threads = 1;
  unsigned idle_threads = 0;  ///< additional threads of idle priority, for prefetches
  size_t cache_bytes =
      0;  ///< packed blocks kept in host memory, so blocks evicted from the GPU need not be decoded again
  size_t ready_bytes = 0;  ///< loaded blocks not yet taken at which the workers pause
};

/// Worker threads that read, decode and pack blocks for one other thread, the only one that may call the methods. They
/// serve the newest list of requests only: a request that is not on it any more is dropped before its block is decoded.
/// Additional threads of idle priority load blocks that may be requested soon into host memory.
class BlockLoader {
 public:
  /// `guard`, if any, must outlive the loader.
  explicit BlockLoader(const LoaderLimits& limits, LoadGuard* guard = nullptr);
  ~BlockLoader();
  BlockLoader(const BlockLoader&) = delete;
  BlockLoader& operator=(const BlockLoader&) = delete;

  static constexpr size_t kAll = std::numeric_limits<size_t>::max();

  /// Replaces the requests, most urgent first, all with attributes or all without. Blocks that are currently being
  /// decoded are finished; if they are no longer requested, they are kept in host memory. The source is told of the
  /// first `announced` blocks that are to be loaded.
  void set_requests(const std::shared_ptr<const BlockSource>& source, std::span<const uint32_t> blocks,
                    bool attributes = false, size_t announced = kAll);
  /// Replaces the list of blocks that may be requested soon, most urgent first. The list is cut off at half of the host
  /// memory for blocks.
  void prefetch(const std::shared_ptr<const BlockSource>& source, std::span<const uint32_t> blocks, bool attributes);
  /// The next requested block, of that model if one is given, that has been loaded; this completes its request.
  std::optional<LoadedBlock> take(std::optional<uint64_t> model = std::nullopt);
  /// Waits until take() would return a block, at most this long.
  void wait(std::chrono::milliseconds most);
  /// A block in host memory; null if it is not there.
  [[nodiscard]] std::shared_ptr<const PackedBlock> find(const BlockId& id);
  void release_model(uint64_t model);

 private:
  struct Request {
    std::shared_ptr<const BlockSource> source;
    BlockId id;
  };
  using Unit = std::pair<uint64_t, uint64_t>;  ///< of a model; see BlockSource::unit_of

  [[nodiscard]] static Unit unit_of(const Request& request);
  [[nodiscard]] std::deque<Request>::iterator next_request();
  void work();
  void work_on_prefetches();
  [[nodiscard]] LoadedBlock load(const Request& request, std::unique_lock<std::mutex>& lock);
  void keep(const LoadedBlock& loaded);
  void finish(LoadedBlock loaded);
  void make_ready(LoadedBlock loaded);
  void forget_queued();
  void drop_unwanted();

  const LoaderLimits limits_;
  LoadGuard* const guard_;
  std::mutex mutex_;  ///< guards the following members
  std::condition_variable wake_workers_;
  std::condition_variable wake_prefetchers_;
  std::condition_variable wake_taker_;
  std::deque<Request> queue_;
  std::deque<Request> prefetch_queue_;  ///< blocks that may be requested soon
  std::set<BlockId> prefetching_;       ///< prefetched blocks being decoded
  std::set<BlockId> damaged_prefetches_;
  std::set<BlockId> requested_;  ///< requests whose blocks have not been taken
  std::set<BlockId> announced_;  ///< requests in the queue of which the source was told
  std::set<BlockId> busy_;       ///< requested blocks being decoded
  std::set<Unit> busy_units_;    ///< of these
  std::deque<LoadedBlock> ready_;
  size_t ready_bytes_ = 0;
  LruCache<BlockId, PackedBlock> cache_;
  bool stopping_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace surfcast::residency
