#include "net/kept_sessions.h"

#include <algorithm>
#include <utility>

#include "access/secret.h"

namespace surfcast::net {

std::string KeptSessions::name_of(const std::string& secret) {
  return access::sha256(secret);
}

std::string KeptSessions::begin(std::weak_ptr<Holder> holder, std::string owner, std::string client) {
  if (limits_.sessions == 0) return {};
  std::string secret = access::make_secret();
  sessions_.emplace(name_of(secret), Session{std::move(holder), std::move(owner), std::move(client)});
  return secret;
}

void KeptSessions::keep(const std::string& secret, std::vector<KeptView> views, Clock::time_point now) {
  const auto found = sessions_.find(name_of(secret));
  if (found == sessions_.end()) return;
  std::erase_if(views, [this](const KeptView& view) { return sizeof view + view.picture.size() > limits_.view_bytes; });
  if (views.empty()) {
    sessions_.erase(found);
    return;
  }
  drop_outdated(now);
  found->second.views = std::move(views);
  found->second.waiting = true;
  found->second.since = now;
  make_room();
}

std::vector<KeptView> KeptSessions::take(const std::string& secret, const std::string& owner, Clock::time_point now) {
  drop_outdated(now);
  const auto found = sessions_.find(name_of(secret));
  if (found == sessions_.end() || found->second.owner != owner) return {};
  Session session = std::move(found->second);
  sessions_.erase(found);
  if (session.waiting) return std::move(session.views);
  const auto holder = session.holder.lock();  // the server has not noticed yet that this connection is gone
  return holder ? holder->hand_over() : std::vector<KeptView>();
}

size_t KeptSessions::waiting(Clock::time_point now) {
  drop_outdated(now);
  return static_cast<size_t>(
      std::ranges::count_if(sessions_, [](const auto& session) { return session.second.waiting; }));
}

void KeptSessions::drop_outdated(Clock::time_point now) {
  std::erase_if(sessions_,
                [&](const auto& named) { return named.second.waiting && now - named.second.since > limits_.time; });
}

/// Whoever has many sessions loses one of them, and nobody else.
void KeptSessions::make_room() {
  std::map<std::string, size_t> counts;
  size_t all = 0;
  for (const auto& [name, session] : sessions_) {
    if (!session.waiting) continue;
    ++counts[session.client];
    ++all;
  }
  if (all <= limits_.sessions) return;
  const auto by_count = [](const auto& a, const auto& b) { return a.second < b.second; };
  const std::string most = std::ranges::max_element(counts, by_count)->first;
  auto oldest = sessions_.end();
  for (auto one = sessions_.begin(); one != sessions_.end(); ++one) {
    if (!one->second.waiting || one->second.client != most) continue;
    if (oldest == sessions_.end() || one->second.since < oldest->second.since) oldest = one;
  }
  sessions_.erase(oldest);
}

}  // namespace surfcast::net
