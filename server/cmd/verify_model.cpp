#include "cmd/verify_model.h"

#include <atomic>

#include <oneapi/tbb/parallel_for.h>

namespace surfcast::cmd {

Status verify_model(const model::ModelFile& model, kinds::KindTable kinds) {
  const Result<std::vector<uint32_t>> numbers = kinds::find_kinds(model, kinds);
  if (!numbers) return fail(numbers.error());
  const auto decode = [&](size_t block) {
    return kinds[(*numbers)[model.blocks()[block].kind]]->decode(model, static_cast<uint32_t>(block));
  };
  std::atomic<size_t> first_bad = model.blocks().size();
  oneapi::tbb::parallel_for(size_t{0}, model.blocks().size(), [&](size_t block) {
    if (block > first_bad || decode(block)) return;
    size_t bad = first_bad;
    while (block < bad && !first_bad.compare_exchange_weak(bad, block)) {
    }
  });
  if (first_bad == model.blocks().size()) return {};
  return fail(decode(first_bad).error());
}

}  // namespace surfcast::cmd
