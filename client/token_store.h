#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"
#include "protocol/endpoint.h"

namespace surfcast::client {

/// Where `surfcast login` keeps tokens: $XDG_CONFIG_HOME/surfcast/tokens.json, or ~/.config/surfcast/tokens.json.
std::filesystem::path token_store();

/// The token that was kept for a server; empty: none. A token of an encrypted address is not for one that is not.
std::string stored_token(const std::filesystem::path& store, const protocol::Endpoint& server);

/// Keeps a token, or forgets it if it is empty. The file is its owner's alone.
Status store_token(const std::filesystem::path& store, const protocol::Endpoint& server, const std::string& token);

}  // namespace surfcast::client
