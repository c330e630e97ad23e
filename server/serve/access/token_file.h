#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "access/principal.h"
#include "base/result.h"

namespace surfcast::access {

/// The file of tokens, JSON. It holds no secrets, only what they hash to:
///
///     {"tokens": [{"name": "alice", "sha256": "9f86...", "models": ["church*"], "expires": "2027-01-31T12:00:00Z",
///                  "connections": 8, "views": 4, "uploads": true, "annotations": true}]}
///
/// All but name and sha256 may be left out; without "models" a token sees none. Errors name the file.
Result<std::vector<Principal>> read_tokens(const std::filesystem::path& file);

/// Replaces the file; its owner alone may read and write it if it is new.
Status write_tokens(const std::filesystem::path& file, const std::vector<Principal>& tokens);

/// "2027-01-31T12:00:00Z" (RFC 3339, in UTC).
std::string time_text(Principal::Time time);
Result<Principal::Time> parse_time(std::string_view text);

}  // namespace surfcast::access
