#include "tls/trust.h"

#include <boost/asio/ip/address.hpp>
#include <boost/asio/ssl/error.hpp>

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>
#include <openssl/x509v3.h>

namespace surfcast::tls {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

Result<std::shared_ptr<ssl::context>> make_trust(const std::string& ca) {
  auto context = std::make_shared<ssl::context>(ssl::context::tls_client);
  ::SSL_CTX_set_min_proto_version(context->native_handle(), TLS1_2_VERSION);
  error_code code;
  if (ca.empty()) {
    context->set_default_verify_paths(code);
  } else {
    context->load_verify_file(ca, code);
  }
  if (code) return fail(ErrorKind::kIo, (ca.empty() ? "certificates of the system" : ca) + ": " + code.message());
  context->set_verify_mode(ssl::verify_peer);
  return context;
}

void expect_host(Stream<boost::asio::ip::tcp::socket>& stream, const std::string& host) {
  error_code not_an_address;
  boost::asio::ip::make_address(host, not_an_address);
  SSL* const native = stream.encryption()->native_handle();
  X509_VERIFY_PARAM* const wanted = ::SSL_get0_param(native);
  if (!not_an_address) {  // which is not named in the handshake: RFC 6066, 3
    ::X509_VERIFY_PARAM_set1_ip_asc(wanted, host.c_str());
    return;
  }
  SSL_set_tlsext_host_name(native, host.c_str());  // NOLINT: a macro that casts
  ::X509_VERIFY_PARAM_set_hostflags(wanted, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
  ::X509_VERIFY_PARAM_set1_host(wanted, host.c_str(), host.size());
}

std::string explain_handshake(Stream<boost::asio::ip::tcp::socket>& stream, const error_code& code) {
  const long verified = ::SSL_get_verify_result(stream.encryption()->native_handle());
  if (verified != X509_V_OK) {
    return std::string("the server's certificate is not trusted: ") + ::X509_verify_cert_error_string(verified);
  }
  if (code.category() == boost::asio::error::get_ssl_category()) {
    const int reason = ERR_GET_REASON(static_cast<unsigned long>(code.value()));
    if (reason == SSL_R_WRONG_VERSION_NUMBER) return "the server does not speak TLS";
  }
  return "no encrypted connection: " + code.message();
}

}  // namespace surfcast::tls
