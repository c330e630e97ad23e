#include "residency/block_loader.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "base/idle_priority.h"
#include "base/stopwatch.h"

namespace surfcast::residency {
namespace {

size_t bytes_of(const LoadedBlock& loaded) {
  return loaded.block ? (*loaded.block)->bytes() : 0;
}

/// Returns exceptions (out of memory) as errors, so one block cannot terminate the server.
Result<std::shared_ptr<const PackedBlock>> load_block(const BlockSource& source, const BlockId& id) {
  try {
    Result<PackedBlock> packed = source.load(id.block, id.attributes);
    if (!packed) return fail(packed);
    return std::make_shared<const PackedBlock>(std::move(*packed));
  } catch (const std::exception& error) {
    return fail(ErrorKind::kInternal, std::string("unexpected: ") + error.what());
  }
}

/// The same under the eyes of a guard.
Result<std::shared_ptr<const PackedBlock>> load_guarded(const BlockSource& source, const BlockId& id,
                                                        LoadGuard* guard) {
  if (guard == nullptr) return load_block(source, id);
  if (Status entered = guard->enter(id); !entered) return fail(entered);
  Result<std::shared_ptr<const PackedBlock>> loaded = load_block(source, id);
  guard->leave(id);
  return loaded;
}

size_t max_packed_bytes(uint32_t surfels) {
  return size_t{kMaxPackedPerSurfel} * surfels * sizeof(glm::uvec4);
}

}  // namespace

BlockLoader::BlockLoader(const LoaderLimits& limits, LoadGuard* guard)
    : limits_(limits), guard_(guard), cache_(limits.cache_bytes) {
  for (unsigned i = 0; i < std::max(1U, limits.threads); ++i) {
    threads_.emplace_back([this] { work(); });
  }
  for (unsigned i = 0; i < limits.idle_threads; ++i) threads_.emplace_back([this] { work_on_prefetches(); });
}

BlockLoader::~BlockLoader() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_workers_.notify_all();
  wake_prefetchers_.notify_all();
  threads_.clear();
}

void BlockLoader::set_requests(const std::shared_ptr<const BlockSource>& source, std::span<const uint32_t> blocks,
                               bool attributes, size_t announced) {
  {
    const std::lock_guard lock(mutex_);
    requested_.clear();
    for (const uint32_t block : blocks) requested_.insert({source->id(), block, attributes});
    forget_queued();
    drop_unwanted();
    std::set<BlockId> coming = busy_;
    for (const LoadedBlock& loaded : ready_) coming.insert(loaded.id);
    std::vector<uint32_t> fresh;
    for (const uint32_t block : blocks) {
      const BlockId id{source->id(), block, attributes};
      if (!coming.insert(id).second) continue;
      if (std::shared_ptr<const PackedBlock> cached = cache_.find(id)) {
        if (announced_.erase(id) > 0) source->forget(block);  // an idle thread has loaded it
        make_ready({id, std::move(cached), 0});
      } else {
        queue_.push_back({source, id});
        if (queue_.size() <= announced && announced_.insert(id).second) fresh.push_back(block);
      }
    }
    // The disk or the store reads these blocks while the first ones are decoded.
    if (!fresh.empty()) source->prefetch(fresh);
  }
  wake_workers_.notify_all();
}

void BlockLoader::prefetch(const std::shared_ptr<const BlockSource>& source, std::span<const uint32_t> blocks,
                           bool attributes) {
  {
    const std::lock_guard lock(mutex_);
    prefetch_queue_.clear();
    size_t bytes = 0;
    for (const uint32_t block : blocks) {
      const BlockId id{source->id(), block, attributes};
      bytes += max_packed_bytes(source->tree().blocks()[block].items);
      if (bytes > limits_.cache_bytes / 2) break;
      if (!busy_.contains(id) && !prefetching_.contains(id) && !damaged_prefetches_.contains(id) && !cache_.find(id)) {
        prefetch_queue_.push_back({source, id});
      }
    }
  }
  wake_prefetchers_.notify_all();
}

/// Empties the queue, and tells the sources which of its blocks are not requested any more.
void BlockLoader::forget_queued() {
  for (const Request& request : std::exchange(queue_, {})) {
    if (!requested_.contains(request.id) && announced_.erase(request.id) > 0) request.source->forget(request.id.block);
  }
}

void BlockLoader::drop_unwanted() {
  std::deque<LoadedBlock> loaded = std::exchange(ready_, {});
  ready_bytes_ = 0;
  for (LoadedBlock& block : loaded) finish(std::move(block));
}

void BlockLoader::make_ready(LoadedBlock loaded) {
  ready_bytes_ += bytes_of(loaded);
  ready_.push_back(std::move(loaded));
}

void BlockLoader::keep(const LoadedBlock& loaded) {
  cache_.put(loaded.id, *loaded.block, bytes_of(loaded));
}

void BlockLoader::finish(LoadedBlock loaded) {
  // A prefetch thread of idle priority may be decoding the same block, so a request can be answered twice.
  const bool again = std::ranges::find(ready_, loaded.id, &LoadedBlock::id) != ready_.end();
  if (requested_.contains(loaded.id) && !again) {
    make_ready(std::move(loaded));
  } else if (loaded.block) {
    keep(loaded);
  }
}

std::optional<LoadedBlock> BlockLoader::take(std::optional<uint64_t> model) {
  std::optional<LoadedBlock> loaded;
  {
    const std::lock_guard lock(mutex_);
    const auto next =
        std::ranges::find_if(ready_, [&](const LoadedBlock& block) { return !model || block.id.model == *model; });
    if (next == ready_.end()) return std::nullopt;
    loaded = std::move(*next);
    ready_.erase(next);
    ready_bytes_ -= bytes_of(*loaded);
    requested_.erase(loaded->id);
    if (loaded->block) keep(*loaded);
  }
  wake_workers_.notify_all();
  return loaded;
}

void BlockLoader::wait(std::chrono::milliseconds most) {
  std::unique_lock lock(mutex_);
  wake_taker_.wait_for(lock, most, [this] { return !ready_.empty(); });
}

std::shared_ptr<const PackedBlock> BlockLoader::find(const BlockId& id) {
  const std::lock_guard lock(mutex_);
  return cache_.find(id);
}

void BlockLoader::release_model(uint64_t model) {
  const std::lock_guard lock(mutex_);
  cache_.erase_range({model, 0}, {model + 1, 0});
  damaged_prefetches_.erase(damaged_prefetches_.lower_bound({model, 0}),
                            damaged_prefetches_.lower_bound({model + 1, 0}));
}

/// Decodes a block without holding the lock.
LoadedBlock BlockLoader::load(const Request& request, std::unique_lock<std::mutex>& lock) {
  lock.unlock();
  const Stopwatch watch;
  LoadedBlock loaded{request.id, load_guarded(*request.source, request.id, guard_), watch.milliseconds()};
  lock.lock();
  return loaded;
}

BlockLoader::Unit BlockLoader::unit_of(const Request& request) {
  return {request.id.model, request.source->unit_of(request.id.block)};
}

/// The first request for which no worker would wait for another one.
std::deque<BlockLoader::Request>::iterator BlockLoader::next_request() {
  return std::ranges::find_if(queue_,
                              [this](const Request& request) { return !busy_units_.contains(unit_of(request)); });
}

void BlockLoader::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    std::deque<Request>::iterator next;
    wake_workers_.wait(lock, [&] {
      if (stopping_) return true;
      next = next_request();
      return next != queue_.end() && ready_bytes_ < limits_.ready_bytes;
    });
    if (stopping_) return;
    const Request request = std::move(*next);
    queue_.erase(next);
    announced_.erase(request.id);
    const Unit unit = unit_of(request);
    busy_.insert(request.id);
    busy_units_.insert(unit);
    LoadedBlock loaded = load(request, lock);
    busy_.erase(request.id);
    busy_units_.erase(unit);
    finish(std::move(loaded));
    wake_taker_.notify_one();
    wake_workers_.notify_all();  // others of the unit
  }
}

void BlockLoader::work_on_prefetches() {
  use_idle_priority();
  std::unique_lock lock(mutex_);
  while (true) {
    wake_prefetchers_.wait(lock, [this] { return stopping_ || !prefetch_queue_.empty(); });
    if (stopping_) return;
    const Request request = std::move(prefetch_queue_.front());
    prefetch_queue_.pop_front();
    if (busy_.contains(request.id) || cache_.find(request.id)) continue;  // requested meanwhile
    prefetching_.insert(request.id);
    LoadedBlock loaded = load(request, lock);
    prefetching_.erase(request.id);
    if (!loaded.block) damaged_prefetches_.insert(request.id);
    finish(std::move(loaded));
    wake_taker_.notify_one();
  }
}

}  // namespace surfcast::residency
