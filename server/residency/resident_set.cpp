#include "residency/resident_set.h"

#include <algorithm>
#include <numeric>

namespace surfcast {

Result<const ResidentModel*> ResidentSet::require(const ModelFile& model) {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.model == model.id(); });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
    return &entries_.front().resident;
  }
  Result<ResidentModel> loaded = ResidentModel::load(model);
  if (!loaded) return fail(std::move(loaded.error()));
  entries_.push_front({model.id(), std::move(*loaded)});
  while (entries_.size() > 1 && gpu_bytes() > budget_) entries_.pop_back();
  return &entries_.front().resident;
}

void ResidentSet::forget(const ModelFile& model) {
  entries_.remove_if([&](const Entry& e) { return e.model == model.id(); });
}

size_t ResidentSet::gpu_bytes() const {
  return std::accumulate(entries_.begin(), entries_.end(), size_t{0},
                         [](size_t sum, const Entry& e) { return sum + e.resident.gpu_bytes(); });
}

}  // namespace surfcast
