#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <shared_mutex>
#include <string>
#include <vector>

#include "residency/load_guard.h"
#include "worker/shared_board.h"

namespace surfcast::worker {

/// Notes on the board which blocks are being loaded. Refuses blocks that are quarantined, and loads those that are
/// suspected one at a time, while no other block is loaded.
class BoardGuard : public residency::LoadGuard {
 public:
  /// `board` must outlive the guard.
  explicit BoardGuard(const SharedBoard& board) : board_(board) {}

  /// A model of the worker, and what the server calls it.
  struct Model {
    uint64_t number = 0;
    std::string path;
    std::set<uint32_t> quarantined;
    std::set<uint32_t> suspected;
  };
  void add(uint64_t model_id, Model model);
  void remove(uint64_t model_id);

  [[nodiscard]] Status enter(const residency::BlockId& id) override;
  void leave(const residency::BlockId& id) override;

 private:
  struct Loading {
    size_t slot = kBoardSlots;
    bool alone = false;
  };

  const SharedBoard& board_;
  std::mutex mutex_;  ///< guards what follows
  std::map<uint64_t, Model> models_;
  std::map<residency::BlockId, std::vector<Loading>> loading_;  ///< a prefetch may load a block that is being loaded
  std::shared_mutex alone_;                                     ///< held by all that load, by a suspect alone
};

}  // namespace surfcast::worker
