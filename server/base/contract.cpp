#include "base/contract.h"

#include <cstdio>
#include <cstdlib>

namespace surfcast {

void contract_broken(const char* condition, std::source_location where) {
  std::fprintf(stderr, "surfcast: broken contract: %s (%s:%u, %s)\n", condition, where.file_name(), where.line(),
               where.function_name());
  std::abort();
}

}  // namespace surfcast
