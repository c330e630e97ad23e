#include "access/secret.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include <openssl/evp.h>
#include <openssl/rand.h>

#include "base/contract.h"

namespace surfcast::access {
namespace {

constexpr std::string_view kBase64Url = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr size_t kSecretBytes = 32;
constexpr size_t kSecretCharacters = 43;  // of six bits each

std::string base64url(std::span<const uint8_t> bytes) {
  std::string text;
  uint32_t bits = 0;
  int count = 0;
  for (const uint8_t byte : bytes) {
    bits = bits << 8 | byte;
    for (count += 8; count >= 6; count -= 6) text += kBase64Url[bits >> (count - 6) & 63];
  }
  if (count > 0) text += kBase64Url[bits << (6 - count) & 63];
  return text;
}

}  // namespace

std::string make_secret() {
  std::array<uint8_t, kSecretBytes> bytes{};
  SURFCAST_EXPECTS(::RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1);
  return base64url(bytes);
}

bool is_secret(std::string_view text) {
  return text.size() == kSecretCharacters && text.find_first_not_of(kBase64Url) == std::string_view::npos;
}

std::string sha256(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::array<uint8_t, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  SURFCAST_EXPECTS(::EVP_Digest(text.data(), text.size(), digest.data(), &size, ::EVP_sha256(), nullptr) == 1);
  std::string hex;
  for (const uint8_t byte : std::span(digest).first(size)) {
    hex += kDigits[byte >> 4];
    hex += kDigits[byte & 15];
  }
  return hex;
}

}  // namespace surfcast::access
