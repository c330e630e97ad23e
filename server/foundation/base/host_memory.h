#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace surfcast {

/// Memory of the machine as far as this process may use it, bytes. A limit of its control group (a container, a systemd
/// unit) lowers both figures.
struct HostMemory {
  uint64_t total = 0;
  uint64_t available = 0;  ///< free, or given back by the system's caches on demand
};

/// Reads /proc and /sys below `root`. A figure that the system does not state is 0.
HostMemory read_host_memory(const std::filesystem::path& root = "/");

/// The files, below the root of the file system, that may state a memory limit of the process whose
/// /proc/self/cgroup has that content: of its group and of every group above, of control groups of version 2 and 1.
/// In a container the path of the group is often that of the host, and only the topmost file exists.
std::vector<std::filesystem::path> memory_limit_files(std::string_view control_groups);

}  // namespace surfcast
