#include "protocol/url_query.h"

#include <algorithm>
#include <set>

namespace surfcast::protocol {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// The byte encoded by the escape at `text[i]` ("%2C"); -1 for a malformed escape.
int escaped_byte(std::string_view text, size_t i) {
  if (i + 2 >= text.size()) return -1;
  const int high = hex_digit(text[i + 1]);
  const int low = hex_digit(text[i + 2]);
  return high < 0 || low < 0 ? -1 : high * 16 + low;
}

/// In a query, a plus sign stands for a blank.
Result<std::string> decode_query(std::string_view text) {
  std::string blanks(text);
  std::replace(blanks.begin(), blanks.end(), '+', ' ');
  return decode_escapes(blanks);
}

}  // namespace

Result<std::string> decode_escapes(std::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
    } else {
      const int byte = escaped_byte(text, i);
      if (byte <= 0) return fail(ErrorKind::kInvalidInput, "the URL has a malformed escape");
      decoded += static_cast<char>(byte);
      i += 2;
    }
  }
  return decoded;
}

std::string encode_escapes(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  constexpr std::string_view kUnreserved = "-._~";  // RFC 3986, 2.3
  std::string escaped;
  for (const char letter : text) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool plain = (byte | 0x20) >= 'a' && (byte | 0x20) <= 'z';
    if (plain || (byte >= '0' && byte <= '9') || kUnreserved.find(letter) != std::string_view::npos) {
      escaped += letter;
    } else {
      escaped += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return escaped;
}

Status for_each_parameter(std::string_view query, const SetParameter& set) {
  std::set<std::string> seen;
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), part.size() + 1));
    if (part.empty()) continue;
    const size_t equals = part.find('=');
    const Result<std::string> name = decode_query(part.substr(0, equals));
    const Result<std::string> text = decode_query(equals == std::string_view::npos ? "" : part.substr(equals + 1));
    if (!name) return fail(name);
    if (!text) return fail(text);
    if (!seen.insert(*name).second) return fail(ErrorKind::kInvalidInput, *name + ": given twice");
    if (Status status = set(*name, *text); !status) return fail(ErrorKind::kInvalidInput, status.error().message);
  }
  return {};
}

}  // namespace surfcast::protocol
