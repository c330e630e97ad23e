#pragma once

#include <chrono>
#include <cstdint>

namespace surfcast {

/// Elapsed wall time since construction.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  [[nodiscard]] double milliseconds() const { return seconds() * 1e3; }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Peak resident set size of this process, bytes.
uint64_t peak_resident_bytes();

}  // namespace surfcast
