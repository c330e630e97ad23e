#include "net/gatekeeper.h"

#include <functional>
#include <utility>

#include "access/token_file.h"

namespace surfcast::net {
namespace {

/// Wrong secrets of a client in a minute that are answered at once. Not a setting: a secret has 256 bits, and cannot be
/// guessed at any rate.
constexpr size_t kFreeFailures = 10;
constexpr std::chrono::minutes kMemory{1};
constexpr std::chrono::milliseconds kPenalty{1000};

/// Why a user who has `open` of `limit` things may not have another; empty: they may. 0: there is no limit.
std::string refusal_of_one_more(size_t open, size_t limit, const char* things) {
  if (limit == 0 || open < limit) return {};
  return "busy: this token opens " + std::to_string(limit) + " " + things + " at a time";
}

}  // namespace

Status Gatekeeper::read() {
  if (!wants_tokens()) return {};
  auto principals = access::read_tokens(file_);
  if (!principals) return fail(principals);
  table_ = std::make_shared<const access::TokenTable>(std::move(*principals));
  return {};
}

access::Rights Gatekeeper::rights(const User& user) const {
  return wants_tokens() ? access::Rights::of(user) : access::Rights::unlimited();
}

Gatekeeper::User Gatekeeper::enter(std::string_view secret, const std::string& client) {
  if (!table_) return nullptr;
  User user = table_->find(secret, std::chrono::system_clock::now());
  if (user) return user;
  ++denied_;
  const Clock::time_point now = Clock::now();
  std::erase_if(failures_, [&](const auto& entry) { return now - entry.second.since > kMemory; });
  Failures& failures = failures_.try_emplace(client, Failures{now}).first->second;
  ++failures.count;
  return nullptr;
}

std::chrono::milliseconds Gatekeeper::penalty(const std::string& client) const {
  const auto found = failures_.find(client);
  const bool lately = found != failures_.end() && Clock::now() - found->second.since <= kMemory;
  return lately && found->second.count > kFreeFailures ? kPenalty : std::chrono::milliseconds(0);
}

std::string Gatekeeper::why_ended(const User& user) const {
  if (!user || !table_) return {};
  return table_->why_ended(*user, std::chrono::system_clock::now());
}

std::string Gatekeeper::refusal_of_connection(const User& user) const {
  if (!user) return {};
  return refusal_of_one_more(users_->counts_of(user->name).connections, user->connections, "connections");
}

std::string Gatekeeper::refusal_of_view(const User& user) const {
  if (!user) return {};
  return refusal_of_one_more(users_->counts_of(user->name).views, user->views, "views");
}

std::optional<Counted> Gatekeeper::count(const User& user, size_t Clients::Counts::*what) const {
  if (!user) return std::nullopt;
  return Counted(users_, user->name, what);
}

service::ClientId client_id(const std::string& client, const Gatekeeper::User& user) {
  return std::hash<std::string>()(user ? "token " + user->name : client);
}

}  // namespace surfcast::net
