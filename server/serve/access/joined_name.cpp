#include "access/joined_name.h"

#include <algorithm>

namespace surfcast::access {

std::vector<std::string> members_of(std::string_view name) {
  std::vector<std::string> members;
  for (;;) {
    const size_t end = std::min(name.find(kJoin), name.size());
    if (end == 0) return {};
    members.emplace_back(name.substr(0, end));
    if (end == name.size()) break;
    name.remove_prefix(end + 1);
  }
  if (members.size() < 2) return {};
  return members;
}

}  // namespace surfcast::access
