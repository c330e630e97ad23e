#include "worker/board_guard.h"

#include <utility>

namespace surfcast::worker {

void BoardGuard::add(uint64_t model_id, Model model) {
  const std::lock_guard lock(mutex_);
  models_[model_id] = std::move(model);
}

void BoardGuard::remove(uint64_t model_id) {
  const std::lock_guard lock(mutex_);
  models_.erase(model_id);
}

Status BoardGuard::enter(const residency::BlockId& id) {
  Loading loading;
  BoardBlock noted;
  {
    const std::lock_guard lock(mutex_);
    const auto found = models_.find(id.model);
    if (found == models_.end()) return fail(ErrorKind::kNotFound, "a block of a model that is not drawn any more");
    const Model& model = found->second;
    if (model.quarantined.contains(id.block)) {
      return fail(ErrorKind::kInvalidInput, model.path + ": block " + std::to_string(id.block) +
                                                ": not loaded any more, because it has ended two render workers");
    }
    noted = {model.number, id.block};
    loading.alone = model.suspected.contains(id.block);
  }
  if (loading.alone) {
    alone_.lock();
  } else {
    alone_.lock_shared();
  }
  loading.slot = board_.note(noted);
  const std::lock_guard lock(mutex_);
  loading_[id].push_back(loading);
  return {};
}

void BoardGuard::leave(const residency::BlockId& id) {
  Loading loading;
  {
    const std::lock_guard lock(mutex_);
    const auto found = loading_.find(id);
    loading = found->second.back();
    found->second.pop_back();
    if (found->second.empty()) loading_.erase(found);
  }
  board_.clear(loading.slot);
  if (loading.alone) {
    alone_.unlock();
  } else {
    alone_.unlock_shared();
  }
}

}  // namespace surfcast::worker
