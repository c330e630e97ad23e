#pragma once

#include <cstdlib>

namespace surfcast::testing {

/// How many samples a test tries: as many as the environment variable `name` says, which `make nightly` sets, or
/// `usual`.
inline int sample_size(const char* name, int usual) {
  const char* wanted = std::getenv(name);
  return wanted == nullptr ? usual : std::atoi(wanted);
}

}  // namespace surfcast::testing
