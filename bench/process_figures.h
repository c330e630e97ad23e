#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace surfcast::bench {

/// Memory that another process of this machine has resident, bytes; 0 when there is no such process.
inline uint64_t resident_bytes(int process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string word; status >> word;) {
    if (word != "VmRSS:") continue;
    uint64_t kibibytes = 0;
    status >> kibibytes;
    return kibibytes << 10;
  }
  return 0;
}

/// Descriptors that it has open.
inline int64_t open_descriptors(int process) {
  std::error_code code;
  const std::filesystem::directory_iterator entries("/proc/" + std::to_string(process) + "/fd", code);
  return code ? 0 : std::distance(begin(entries), end(entries));
}

}  // namespace surfcast::bench
