#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tls/certificate_files.h"

namespace surfcast::net {

/// Makes a certificate that signs itself, and its key, for these names ("DNS:localhost,IP:127.0.0.1"). Files that are
/// there are replaced, one after the other.
inline tls::CertificateFiles make_certificate(const std::filesystem::path& folder,
                                              const std::string& names = "DNS:localhost,IP:127.0.0.1") {
  std::filesystem::create_directories(folder);
  const tls::CertificateFiles files{folder / "tls.crt", folder / "tls.key"};
  const std::string command =
      "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=test -addext "
      "subjectAltName=" +
      names + " -keyout '" + files.key.string() + "' -out '" + files.certificate.string() + "' 2> /dev/null";
  if (std::system(command.c_str()) != 0) std::abort();
  return files;
}

}  // namespace surfcast::net
