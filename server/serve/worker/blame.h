#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "worker/shared_board.h"

namespace surfcast::worker {

/// Which blocks have ended workers. After the first time a block is suspected, together with those that were being
/// loaded beside it; from then on it is loaded alone, so that the second time the blame is certain. Thread-safe.
class Blame {
 public:
  /// A worker has ended while it loaded these blocks. Returns those that have now ended two workers and are loaded no
  /// more.
  std::vector<BoardBlock> worker_ended(std::span<const BoardBlock> loading);

  [[nodiscard]] std::vector<uint32_t> suspected(uint64_t model) const { return with(model, 1, 1); }
  [[nodiscard]] std::vector<uint32_t> quarantined(uint64_t model) const { return with(model, 2, UINT32_MAX); }
  /// Forgets a model.
  void forget(uint64_t model);

 private:
  [[nodiscard]] std::vector<uint32_t> with(uint64_t model, uint32_t least, uint32_t most) const;

  mutable std::mutex mutex_;
  std::map<uint64_t, std::map<uint32_t, uint32_t>> ends_;  ///< of workers, by model and block
};

}  // namespace surfcast::worker
