#include "net/clients.h"

namespace surfcast::net {
namespace {

bool reaches(size_t count, size_t limit) {
  return limit > 0 && count >= limit;
}

}  // namespace

Clients::Counts Clients::counts_of(const std::string& client) const {
  const auto found = counts_.find(client);
  return found == counts_.end() ? Counts{} : found->second;
}

bool Clients::has_all_its_connections(const std::string& client) const {
  return reaches(counts_of(client).connections, limits_.connections_per_client);
}

std::string Clients::refusal_of_connection(const std::string& client) const {
  if (all_.connections >= limits_.connections) return "the server is busy: too many connections";
  if (has_all_its_connections(client)) {
    return "too many connections from " + client + ": the server takes " +
           std::to_string(limits_.connections_per_client) + " of one client";
  }
  return {};
}

std::string Clients::refusal_of_view(const std::string& client) const {
  if (!reaches(counts_of(client).views, limits_.views_per_client)) return {};
  return "busy: too many views are open from " + client + ": the server takes " +
         std::to_string(limits_.views_per_client) + " of one client";
}

void Clients::add(const std::string& client, size_t Counts::*what) {
  ++(all_.*what);
  ++(counts_[client].*what);
}

void Clients::remove(const std::string& client, size_t Counts::*what) {
  --(all_.*what);
  const auto found = counts_.find(client);
  Counts& counts = found->second;
  --(counts.*what);
  if (counts.connections + counts.refused + counts.views == 0) counts_.erase(found);
}

}  // namespace surfcast::net
