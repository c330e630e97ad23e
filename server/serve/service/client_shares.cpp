#include "service/client_shares.h"

#include <algorithm>
#include <limits>

#include "base/contract.h"

namespace surfcast::service {

/// Of all clients that have jobs; 0 if none has.
double ClientShares::least_used() const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [client, account] : accounts_) {
    if (account.jobs > 0) least = std::min(least, account.used);
  }
  return least == std::numeric_limits<double>::infinity() ? 0 : least;
}

void ClientShares::enter(ClientId client) {
  const double floor = least_used();
  Account& account = accounts_[client];
  if (account.jobs == 0) account.used = std::max(account.used, floor);
  ++account.jobs;
}

void ClientShares::leave(ClientId client) {
  const auto found = accounts_.find(client);
  SURFCAST_EXPECTS(found != accounts_.end() && found->second.jobs > 0);
  --found->second.jobs;
  const bool any = std::ranges::any_of(accounts_, [](const auto& entry) { return entry.second.jobs > 0; });
  if (!any) return accounts_.clear();  // nobody has waited for anybody
  const double floor = least_used();
  std::erase_if(accounts_, [floor](const auto& entry) { return entry.second.jobs == 0 && entry.second.used <= floor; });
}

void ClientShares::charge(ClientId client, double milliseconds) {
  if (const auto found = accounts_.find(client); found != accounts_.end()) found->second.used += milliseconds;
}

double ClientShares::used(ClientId client) const {
  const auto found = accounts_.find(client);
  return found == accounts_.end() ? 0 : found->second.used;
}

}  // namespace surfcast::service
