#include "cmd/verify_model.h"

#include <atomic>

#include <oneapi/tbb/parallel_for.h>

namespace surfcast::cmd {

Status verify_model(const model::ModelFile& model) {
  std::atomic<size_t> first_bad = model.blocks().size();
  oneapi::tbb::parallel_for(size_t{0}, model.blocks().size(), [&](size_t block) {
    if (block > first_bad || model.decode(block)) return;
    size_t bad = first_bad;
    while (block < bad && !first_bad.compare_exchange_weak(bad, block)) {
    }
  });
  if (first_bad == model.blocks().size()) return {};
  return fail(model.decode(first_bad).error());
}

}  // namespace surfcast::cmd
