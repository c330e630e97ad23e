#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace surfcast::access {

/// Whoever has a token, and what they may do.
struct Principal {
  using Time = std::chrono::system_clock::time_point;

  std::string name;
  std::string sha256;               ///< of the secret, 64 hexadecimal digits
  std::vector<std::string> models;  ///< patterns of names: `*`, `?` and `[...]`
  std::optional<Time> expires{};    ///< nothing: never
  size_t connections = 0;           ///< at a time; 0: as many as a client may have
  size_t views = 0;                 ///< at a time; 0: likewise
  bool uploads = false;             ///< may send scans, under names that the patterns allow
  bool annotations = false;         ///< may write saved views and annotations of these models

  bool operator==(const Principal&) const = default;
};

/// Whether the token is no longer good at that time.
bool has_expired(const Principal& principal, Principal::Time now);

}  // namespace surfcast::access
