#include "net/http_credentials.h"

#include <algorithm>
#include <optional>

#include "base/ascii_text.h"
#include "protocol/url_query.h"

namespace surfcast::net {
namespace {

constexpr std::string_view kBearer = "bearer ";
constexpr std::string_view kTokenProtocol = "surfcast.token.";
/// RFC 6265bis, 4.1.3.2: with this prefix no other host and no plain connection can set it.
constexpr std::string_view kCookie = "__Host-surfcast";
constexpr std::string_view kPlainCookie = "surfcast";

/// What follows `prefix` in the first of the items that begins with it.
std::optional<std::string_view> find_item(std::string_view list, char separator, std::string_view prefix) {
  while (!list.empty()) {
    const size_t end = std::min(list.find(separator), list.size());
    const std::string_view item = trimmed(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
    if (item.starts_with(prefix)) return item.substr(prefix.size());
  }
  return std::nullopt;
}

}  // namespace

std::string_view token_of(const HttpCredentials& credentials) {
  if (equal_in_any_case(credentials.authorization.substr(0, kBearer.size()), kBearer)) {
    return trimmed(credentials.authorization.substr(kBearer.size()));
  }
  if (const auto token = find_item(credentials.protocols, ',', kTokenProtocol)) return *token;
  for (const std::string_view name : {kCookie, kPlainCookie}) {
    if (const auto token = find_item(credentials.cookie, ';', std::string(name) + "=")) return *token;
  }
  return {};
}

std::string login_cookie(std::string_view token, bool encrypted) {
  std::string cookie(encrypted ? kCookie : kPlainCookie);
  cookie += "=" + std::string(token) + "; Path=/; HttpOnly; SameSite=Strict";
  if (encrypted) cookie += "; Secure";
  return token.empty() ? cookie + "; Max-Age=0" : cookie;
}

std::string token_of_form(std::string_view body) {
  const auto field = find_item(body, '&', "token=");
  if (!field) return {};
  const Result<std::string> token = protocol::decode_escapes(*field);
  return token ? std::string(trimmed(*token)) : std::string();
}

}  // namespace surfcast::net
