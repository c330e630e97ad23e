#pragma once

#include <filesystem>

#include "base/result.h"

namespace surfcast::tls {

/// Where the server's certificate is, with those that lead from it to one that clients trust, and its private key. Both
/// PEM.
struct CertificateFiles {
  std::filesystem::path certificate;  ///< empty: no TLS
  std::filesystem::path key;
};

/// The files that two flags name: the two themselves, or, without a key, those in a folder, by the names of Kubernetes
/// (tls.crt, tls.key) or of certbot (fullchain.pem, privkey.pem). kInvalidInput when one flag is missing.
Result<CertificateFiles> find_certificate(const std::filesystem::path& certificate, const std::filesystem::path& key);

}  // namespace surfcast::tls
