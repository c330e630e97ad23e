#include "net/trace.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <random>

namespace surfcast::net {
namespace {

// "00-" trace of 32 digits "-" span of 16 digits "-" flags of 2 digits
constexpr size_t kLength = 55;
constexpr size_t kTrace = 3;
constexpr size_t kSpan = 36;
constexpr size_t kFlags = 53;

bool is_hex(std::string_view text) {
  return text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

bool is_zero(std::string_view text) {
  return text.find_first_not_of('0') == std::string_view::npos;
}

/// Later versions may be longer; version ff is none.
bool is_valid(std::string_view text) {
  if (text.size() < kLength || (text.starts_with("00") && text.size() > kLength)) return false;
  if (text.size() > kLength && text[kLength] != '-') return false;
  if (text[2] != '-' || text[kSpan - 1] != '-' || text[kFlags - 1] != '-' || text.starts_with("ff")) return false;
  const std::string_view trace = text.substr(kTrace, 32);
  const std::string_view span = text.substr(kSpan, 16);
  return is_hex(text.substr(0, 2)) && is_hex(trace) && is_hex(span) && is_hex(text.substr(kFlags, 2)) &&
         !is_zero(trace) && !is_zero(span);
}

/// Not 0.
std::string new_span() {
  static thread_local std::mt19937_64 numbers{std::random_device{}()};
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(numbers() | 1));
  return text.data();
}

}  // namespace

std::string answered_trace(std::string_view traceparent) {
  if (!is_valid(traceparent)) return {};
  return "00-" + std::string(traceparent.substr(kTrace, 32)) + "-" + new_span() + "-" +
         std::string(traceparent.substr(kFlags, 2));
}

}  // namespace surfcast::net
