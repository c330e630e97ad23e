#include "base/stopwatch.h"

#include <sys/resource.h>

namespace surfcast {

uint64_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts ru_maxrss in KiB
}

}  // namespace surfcast
