#include "tls/certificate_files.h"

#include <array>
#include <optional>
#include <system_error>
#include <utility>

namespace surfcast::tls {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<const char*, const char*>, 2> kNames{{
    {"tls.crt", "tls.key"},
    {"fullchain.pem", "privkey.pem"},
}};

std::optional<CertificateFiles> files_in(const fs::path& folder) {
  std::error_code code;
  for (const auto& [certificate, key] : kNames) {
    if (fs::exists(folder / certificate, code)) return CertificateFiles{folder / certificate, folder / key};
  }
  return std::nullopt;
}

}  // namespace

Result<CertificateFiles> find_certificate(const fs::path& certificate, const fs::path& key) {
  if (certificate.empty() && key.empty()) return CertificateFiles{};
  std::error_code code;
  if (!certificate.empty() && key.empty() && fs::is_directory(certificate, code)) {
    if (auto found = files_in(certificate)) return std::move(*found);
    return fail(ErrorKind::kNotFound, certificate.string() + ": there is neither tls.crt nor fullchain.pem");
  }
  if (certificate.empty() || key.empty()) {
    return fail(ErrorKind::kInvalidInput, "--tls-certificate and --tls-key go together");
  }
  return CertificateFiles{certificate, key};
}

}  // namespace surfcast::tls
