#pragma once

#include <boost/beast/core/tcp_stream.hpp>

#include "tls/stream.h"

namespace surfcast::net {

/// The connection to a client, with TLS or without.
using ClientStream = tls::Stream<boost::beast::tcp_stream>;

}  // namespace surfcast::net
