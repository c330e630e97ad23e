#include "protocol/errors.h"

#include <array>
#include <cstdint>

#include "surfcast.pb.h"

namespace surfcast::protocol {
namespace {

struct KindNames {
  ErrorKind kind;
  wire::ErrorCode code;
  std::string_view name;
};

constexpr std::array<KindNames, 9> kKinds{{
    {ErrorKind::kInternal, wire::ERROR_CODE_INTERNAL, "internal"},
    {ErrorKind::kInvalidInput, wire::ERROR_CODE_INVALID_INPUT, "invalid_input"},
    {ErrorKind::kUnsupported, wire::ERROR_CODE_UNSUPPORTED, "unsupported"},
    {ErrorKind::kNotFound, wire::ERROR_CODE_NOT_FOUND, "not_found"},
    {ErrorKind::kIo, wire::ERROR_CODE_IO, "io"},
    {ErrorKind::kLimit, wire::ERROR_CODE_LIMIT, "limit"},
    {ErrorKind::kCancelled, wire::ERROR_CODE_CANCELLED, "cancelled"},
    {ErrorKind::kUnavailable, wire::ERROR_CODE_UNAVAILABLE, "unavailable"},
    {ErrorKind::kReplaced, wire::ERROR_CODE_UNAVAILABLE, "unavailable"},  // asked again, it is opened anew
}};

const KindNames& names_of(ErrorKind kind) {
  for (const KindNames& names : kKinds) {
    if (names.kind == kind) return names;
  }
  return kKinds[0];
}

/// Length of the well-formed UTF-8 sequence at the start of `text` (Unicode 15, table 3-7); 0 if there is none.
size_t utf8_sequence(std::string_view text) {
  const auto byte = [text](size_t i) { return i < text.size() ? static_cast<uint8_t>(text[i]) : uint8_t{0}; };
  const auto tail = [byte](size_t i) { return byte(i) >= 0x80 && byte(i) <= 0xbf; };
  const uint8_t first = byte(0);
  const uint8_t second = byte(1);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return tail(1) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    const bool overlong = first == 0xe0 && second < 0xa0;
    const bool surrogate = first == 0xed && second > 0x9f;
    return tail(1) && tail(2) && !overlong && !surrogate ? 3 : 0;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    const bool overlong = first == 0xf0 && second < 0x90;
    const bool beyond = first == 0xf4 && second > 0x8f;
    return tail(1) && tail(2) && tail(3) && !overlong && !beyond ? 4 : 0;
  }
  return 0;
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

}  // namespace

void to_wire(const Error& error, wire::Error& message) {
  message.set_code(names_of(error.kind).code);
  message.set_message(clean_utf8(error.message));
}

Error from_wire(const wire::Error& message) {
  for (const KindNames& names : kKinds) {
    if (names.code == message.code()) return {names.kind, clean_utf8(message.message())};
  }
  if (message.code() == wire::ERROR_CODE_DENIED) return {ErrorKind::kInvalidInput, clean_utf8(message.message())};
  return {ErrorKind::kInternal, clean_utf8(message.message())};
}

std::string_view name_of(ErrorKind kind) {
  return names_of(kind).name;
}

std::string clean_utf8(std::string_view text) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const size_t length = utf8_sequence(text);
    if (length == 0) {
      clean += '?';
    } else if (is_control(text[0])) {
      clean += ' ';
    } else {
      clean += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return clean;
}

}  // namespace surfcast::protocol
