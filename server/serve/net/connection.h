#pragma once

#include <cstddef>
#include <vector>

#include "net/client_stream.h"
#include "net/session.h"

namespace surfcast::net {

/// An accepted connection.
struct Connection {
  ClientStream stream;
  Peer peer;
  std::vector<std::byte> begun{};  ///< what was read of its first words
};

}  // namespace surfcast::net
