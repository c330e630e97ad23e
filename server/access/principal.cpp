#include "access/principal.h"

#include <algorithm>

#include <fnmatch.h>

namespace surfcast::access {

bool may_see(const Principal& principal, const std::string& model) {
  return std::ranges::any_of(
      principal.models, [&](const std::string& pattern) { return ::fnmatch(pattern.c_str(), model.c_str(), 0) == 0; });
}

bool has_expired(const Principal& principal, Principal::Time now) {
  return principal.expires && *principal.expires <= now;
}

}  // namespace surfcast::access
