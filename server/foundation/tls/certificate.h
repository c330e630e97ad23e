#pragma once

#include <boost/asio/ssl/context.hpp>
#include <chrono>
#include <memory>

#include "base/result.h"
#include "tls/certificate_files.h"

namespace surfcast::tls {

/// What connections of a server are encrypted with.
struct ServerIdentity {
  std::shared_ptr<boost::asio::ssl::context> context;
  std::chrono::system_clock::time_point expires;  ///< the certificate
};

/// TLS 1.2 and 1.3, always with forward secrecy and authenticated encryption. Fails with the file's name when the files
/// cannot be read or do not belong together. RFC 9325, 4.2.
Result<ServerIdentity> read_identity(const CertificateFiles& files);

}  // namespace surfcast::tls
