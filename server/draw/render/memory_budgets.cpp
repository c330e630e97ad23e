#include "render/memory_budgets.h"

#include <algorithm>

namespace surfcast::render {

MemoryBudgets default_budgets(const MachineMemory& machine) {
  constexpr uint64_t kMinGpu = uint64_t{64} << 20;
  constexpr uint64_t kMinHost = uint64_t{32} << 20;
  const MemoryBudgets shares = machine.gpu ? MemoryBudgets{*machine.gpu / 4, machine.host / 4}
                                           : MemoryBudgets{machine.host / 8, machine.host / 8};
  return {std::max(shares.gpu, kMinGpu), std::max(shares.host, kMinHost)};
}

}  // namespace surfcast::render
