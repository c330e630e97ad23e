#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <memory>
#include <string>

#include "base/result.h"
#include "tls/stream.h"

namespace surfcast::tls {

/// What a client believes: the certificates in the file `ca` (PEM), or those that the system trusts if it is empty.
Result<std::shared_ptr<boost::asio::ssl::context>> make_trust(const std::string& ca);

/// Makes the handshake fail unless the server's certificate leads to a trusted one and is for `host`, a name or an
/// address. Call it before the handshake.
void expect_host(Stream<boost::asio::ip::tcp::socket>& stream, const std::string& host);

/// What is wrong with a handshake that failed, in words.
std::string explain_handshake(Stream<boost::asio::ip::tcp::socket>& stream, const boost::system::error_code& code);

}  // namespace surfcast::tls
