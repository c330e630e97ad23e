#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace surfcast::testing {

/// Whether a name has the text `what` in it.
inline bool mentions(const std::vector<std::string>& names, const std::string& what) {
  return std::ranges::any_of(names, [&](const std::string& name) { return name.find(what) != std::string::npos; });
}

}  // namespace surfcast::testing
