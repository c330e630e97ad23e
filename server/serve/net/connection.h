#pragma once

#include <boost/beast/core/tcp_stream.hpp>
#include <cstddef>
#include <vector>

#include "net/session.h"
#include "tls/stream.h"

namespace surfcast::net {

/// The connection to a client, with TLS or without.
using ClientStream = tls::Stream<boost::beast::tcp_stream>;

/// An accepted connection.
struct Connection {
  ClientStream stream;
  Peer peer;
  std::vector<std::byte> begun{};  ///< what was read of its first words
};

}  // namespace surfcast::net
