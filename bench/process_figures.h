#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace surfcast::bench {

/// Resident memory of another process on this machine, bytes; 0 if there is no such process.
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

/// Number of open descriptors of a process; 0 if there is no such process.
inline int64_t open_descriptors(int process) {
  std::error_code code;
  const std::filesystem::directory_iterator entries("/proc/" + std::to_string(process) + "/fd", code);
  return code ? 0 : std::distance(begin(entries), end(entries));
}

}  // namespace surfcast::bench
