#pragma once

#include <CLI/CLI.hpp>

#include "client/server_connection.h"

namespace surfcast::client {

/// The flags `--connect-timeout` and `--timeout` of every command. The object must outlive the parsing.
struct TimeLimits {
  double connect = 10;  ///< seconds
  double answer = 120;  ///< seconds

  void add_to(CLI::App& command);
  [[nodiscard]] ClientConfig config(int interrupt) const;
};

}  // namespace surfcast::client
