#pragma once

#include <cstdlib>

namespace surfcast::testing {

/// The number of damaged inputs that a test tries: a sample, or SURFCAST_DAMAGED_INPUTS as in `make nightly`.
inline int damaged_inputs(int sample) {
  const char* wanted = std::getenv("SURFCAST_DAMAGED_INPUTS");
  return wanted == nullptr ? sample : std::atoi(wanted);
}

}  // namespace surfcast::testing
