#include "access/token_table.h"

#include <utility>

#include "access/secret.h"

namespace surfcast::access {

TokenTable::TokenTable(std::vector<Principal> principals) {
  for (Principal& principal : principals) {
    auto shared = std::make_shared<const Principal>(std::move(principal));
    by_hash_.emplace(shared->sha256, shared);
  }
}

std::shared_ptr<const Principal> TokenTable::find(std::string_view secret, Principal::Time now) const {
  if (!is_secret(secret)) return nullptr;
  const auto found = by_hash_.find(sha256(secret));
  return found == by_hash_.end() || has_expired(*found->second, now) ? nullptr : found->second;
}

std::string TokenTable::why_ended(const Principal& principal, Principal::Time now) const {
  const auto found = by_hash_.find(principal.sha256);
  if (found == by_hash_.end()) return "the token was revoked";
  if (has_expired(*found->second, now)) return "the token has expired";
  return *found->second == principal ? "" : "what the token allows has changed";
}

}  // namespace surfcast::access
