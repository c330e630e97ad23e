#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "access/principal.h"

namespace surfcast::access {

/// Principals by their secrets. A secret is found by its hash: how long that takes tells nothing about others.
class TokenTable {
 public:
  explicit TokenTable(std::vector<Principal> principals);

  /// Null when there is no such token, or it has expired.
  [[nodiscard]] std::shared_ptr<const Principal> find(std::string_view secret, Principal::Time now) const;

  /// Why a principal of a former table, or of this one, is no longer served; empty: it is. Whoever may do something
  /// else than before is not, and comes again.
  [[nodiscard]] std::string why_ended(const Principal& principal, Principal::Time now) const;

 private:
  std::map<std::string, std::shared_ptr<const Principal>, std::less<>> by_hash_;
};

}  // namespace surfcast::access
