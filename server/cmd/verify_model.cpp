#include "cmd/verify_model.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

namespace surfcast::cmd {
namespace {

/// Blocks that are announced together, so that a store sends them by few requests.
constexpr size_t kTogether = 256;

}  // namespace

Status verify_model(const model::ModelFile& model, kinds::KindTable kinds) {
  const Result<std::vector<uint32_t>> numbers = kinds::find_kinds(model, kinds);
  if (!numbers) return fail(numbers);
  const auto decode = [&](size_t block) {
    return kinds[(*numbers)[model.blocks()[block].kind]]->decode(model, static_cast<uint32_t>(block));
  };
  const size_t count = model.blocks().size();
  std::atomic<size_t> first_bad = count;
  for (size_t begin = 0; begin < count && first_bad == count; begin += kTogether) {
    const size_t end = std::min(count, begin + kTogether);
    std::vector<uint32_t> blocks(end - begin);
    std::iota(blocks.begin(), blocks.end(), static_cast<uint32_t>(begin));
    model.prefetch(blocks);
    oneapi::tbb::parallel_for(begin, end, [&](size_t block) {
      if (block > first_bad || decode(block)) return;
      size_t bad = first_bad;
      while (block < bad && !first_bad.compare_exchange_weak(bad, block)) {
      }
    });
  }
  if (first_bad == count) return {};
  return fail(decode(first_bad));
}

}  // namespace surfcast::cmd
