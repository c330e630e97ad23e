#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "base/log_limit.h"

namespace surfcast::net {

/// How many denials of one client, and of all clients together, are written: whoever is denied decides how many there
/// would be. Not thread-safe.
class DenialLimit {
 public:
  using Clock = LogLimit::Clock;

  /// `lines` a minute for one client, and kClients times as many for all together; 0: any number.
  explicit DenialLimit(size_t lines) : lines_(lines), all_(lines * kClients) {}

  /// Whether a denial may be written now: nothing if not, else how many of this client before it were left out.
  std::optional<size_t> admit(const std::string& client, Clock::time_point now) {
    if (lines_ == 0) return 0;
    if (clients_.size() >= kRemembered && !clients_.contains(client)) clients_.clear();
    LogLimit& own = clients_.try_emplace(client, lines_).first->second;
    const std::optional<size_t> admitted = own.admit(now);
    if (!admitted || !all_.admit(now)) return std::nullopt;
    return admitted;
  }

 private:
  // Not settings: beyond them there is an attack from many places, and `all_` alone bounds what is written.
  static constexpr size_t kClients = 100;
  static constexpr size_t kRemembered = 4096;

  size_t lines_;
  LogLimit all_;
  std::map<std::string, LogLimit> clients_;
};

}  // namespace surfcast::net
