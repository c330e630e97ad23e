#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "client/server_connection.h"

namespace surfcast::client {

/// The flags of every command that say how to reach a server: `--connect-timeout`, `--timeout`, `--ca` and
/// `--token-file`. The object must outlive the parsing.
struct TimeLimits {
  double connect = 10;  ///< seconds
  double answer = 120;  ///< seconds
  std::string ca;       ///< as in ClientConfig
  std::string token_file;

  void add_to(CLI::App& command);
  /// For a server. Its token is that of the file, of the variable SURFCAST_TOKEN, or that which `login` has kept.
  [[nodiscard]] ClientConfig config(const protocol::Endpoint& server, int interrupt) const;
  /// For requests of one model.
  [[nodiscard]] ClientConfig config(const protocol::ModelUrl& url, int interrupt) const;

 private:
  [[nodiscard]] std::string token_for(const protocol::Endpoint& server) const;
};

}  // namespace surfcast::client
