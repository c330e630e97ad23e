#include "base/contract.h"

#include <cstdio>
#include <cstdlib>

namespace surfcast {

void contract_broken(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "surfcast: broken contract: %s (%s:%d)\n", condition, file, line);
  std::abort();
}

}  // namespace surfcast
