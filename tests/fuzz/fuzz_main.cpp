// The entry of libFuzzer for one target of targets.h, named by SURFCAST_FUZZ_TARGET.
#include <algorithm>
#include <cstdint>

#include "fuzz/targets.h"

namespace {

constexpr auto kTarget =
    std::ranges::find(surfcast::fuzz::kTargets, std::string_view(SURFCAST_FUZZ_TARGET), &surfcast::fuzz::Target::name);
static_assert(kTarget != surfcast::fuzz::kTargets.end());

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  kTarget->run(std::as_bytes(std::span(data, size)));
  return 0;
}
