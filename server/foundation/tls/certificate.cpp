#include "tls/certificate.h"

#include <ctime>
#include <string>
#include <utility>

#include <openssl/ssl.h>
#include <openssl/x509.h>

namespace surfcast::tls {
namespace {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

/// Of TLS 1.2; those of 1.3 are all fit.
constexpr const char* kCiphers = "ECDHE+AESGCM:ECDHE+CHACHA20";

/// When the certificate of a context ends.
std::chrono::system_clock::time_point expiry_of(ssl::context& context) {
  std::tm time{};
  const X509* const certificate = ::SSL_CTX_get0_certificate(context.native_handle());
  if (certificate == nullptr || ::ASN1_TIME_to_tm(::X509_get0_notAfter(certificate), &time) != 1) return {};
  return std::chrono::system_clock::from_time_t(::timegm(&time));
}

}  // namespace

Result<ServerIdentity> read_identity(const CertificateFiles& files) {
  auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
  SSL_CTX* const native = context->native_handle();
  ::SSL_CTX_set_min_proto_version(native, TLS1_2_VERSION);
  ::SSL_CTX_set_options(native, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  if (::SSL_CTX_set_cipher_list(native, kCiphers) != 1) return fail(ErrorKind::kInternal, "no ciphers for TLS 1.2");
  error_code code;
  context->use_certificate_chain_file(files.certificate.string(), code);
  if (code) return fail(ErrorKind::kIo, files.certificate.string() + ": no certificate: " + code.message());
  context->use_private_key_file(files.key.string(), ssl::context::pem, code);
  if (code) return fail(ErrorKind::kIo, files.key.string() + ": not the key of the certificate: " + code.message());
  const auto expires = expiry_of(*context);
  return ServerIdentity{std::move(context), expires};
}

}  // namespace surfcast::tls
