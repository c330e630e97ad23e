#pragma once

#include <string>
#include <string_view>

namespace surfcast::net {

/// Where a request of HTTP may name its token; empty: the header was not there.
struct HttpCredentials {
  std::string_view authorization;  ///< "Bearer TOKEN" (RFC 6750)
  std::string_view cookie;         ///< of login_cookie
  std::string_view protocols;      ///< offered subprotocols of a WebSocket, one of them "surfcast.token.TOKEN"
};

/// The token that a request names, in this order; empty: none.
std::string_view token_of(const HttpCredentials& credentials);

/// The value of a Set-Cookie header that makes a browser name the token; empty: that makes it forget. Scripts do not
/// see it, and pages of other sites do not send it. `encrypted`: the browser came through TLS, and will not send it
/// otherwise.
std::string login_cookie(std::string_view token, bool encrypted);

/// The token in the body of the login page's form; empty: there is none.
std::string token_of_form(std::string_view body);

}  // namespace surfcast::net
