#include "base/host_memory.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

namespace surfcast {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A field of /proc/meminfo, which states KiB; 0 without it.
uint64_t meminfo_bytes(const std::string& text, const std::string& field) {
  const size_t place = ("\n" + text).find("\n" + field + ":");
  if (place == std::string::npos) return 0;
  std::istringstream rest(text.substr(place + field.size() + 1));
  uint64_t kibibytes = 0;
  return rest >> kibibytes ? kibibytes << 10 : 0;
}

/// Files of a group and of those above it.
void add_limit_files(const fs::path& hierarchy, const fs::path& group, const char* name, std::vector<fs::path>& files) {
  for (fs::path place = group.relative_path();; place = place.parent_path()) {
    files.push_back(hierarchy / place / name);
    if (place.empty()) return;
  }
}

bool names_memory(const std::string& controllers) {
  std::istringstream list(controllers);
  for (std::string controller; std::getline(list, controller, ',');) {
    if (controller == "memory") return true;
  }
  return false;
}

/// The smallest limit of the control groups. "max" is no number: there is none.
uint64_t control_group_limit(const fs::path& root) {
  uint64_t least = UINT64_MAX;
  for (const fs::path& file : memory_limit_files(content_of(root / "proc/self/cgroup"))) {
    std::ifstream stream(root / file);
    uint64_t limit = 0;
    if (stream >> limit) least = std::min(least, limit);
  }
  return least;
}

}  // namespace

std::vector<fs::path> memory_limit_files(std::string_view control_groups) {
  std::vector<fs::path> files;
  std::istringstream lines{std::string(control_groups)};
  for (std::string line; std::getline(lines, line);) {  // "4:memory:/path", or of version 2 "0::/path"
    const size_t first = line.find(':');
    const size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const fs::path group = line.substr(second + 1);
    if (controllers.empty()) add_limit_files("sys/fs/cgroup", group, "memory.max", files);
    if (names_memory(controllers)) add_limit_files("sys/fs/cgroup/memory", group, "memory.limit_in_bytes", files);
  }
  return files;
}

HostMemory read_host_memory(const fs::path& root) {
  const std::string meminfo = content_of(root / "proc/meminfo");
  const uint64_t limit = control_group_limit(root);
  return {std::min(meminfo_bytes(meminfo, "MemTotal"), limit), std::min(meminfo_bytes(meminfo, "MemAvailable"), limit)};
}

}  // namespace surfcast
