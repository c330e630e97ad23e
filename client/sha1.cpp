#include "client/sha1.h"

#include <bit>

namespace surfcast::client {
namespace {

using State = std::array<uint32_t, 5>;

/// f and K of step t, FIPS 180-4, sections 4.1.1 and 4.2.1.
uint32_t mix(int t, const State& s) {
  const auto [a, b, c, d, e] = s;
  if (t < 20) return ((b & c) ^ (~b & d)) + 0x5a827999;
  if (t < 40) return (b ^ c ^ d) + 0x6ed9eba1;
  if (t < 60) return ((b & c) ^ (b & d) ^ (c & d)) + 0x8f1bbcdc;
  return (b ^ c ^ d) + 0xca62c1d6;
}

/// Section 6.1.2.
void add_block(State& state, std::string_view block) {
  std::array<uint32_t, 80> w{};
  for (size_t i = 0; i < 64; ++i) w[i / 4] = w[i / 4] << 8 | static_cast<uint8_t>(block[i]);
  for (size_t t = 16; t < 80; ++t) w[t] = std::rotl(w[t - 3] ^ w[t - 8] ^ w[t - 14] ^ w[t - 16], 1);
  State s = state;
  for (int t = 0; t < 80; ++t) {
    const uint32_t next = std::rotl(s[0], 5) + mix(t, s) + s[4] + w[static_cast<size_t>(t)];
    s = {next, s[0], std::rotl(s[1], 30), s[2], s[3]};
  }
  for (size_t i = 0; i < state.size(); ++i) state[i] += s[i];
}

/// The text, a one, zeros, and the length in bits: whole blocks of 64 bytes (section 5.1.1).
std::string padded(std::string_view text) {
  std::string all(text);
  all += '\x80';
  all.resize((all.size() + 8 + 63) / 64 * 64, '\0');
  const uint64_t bits = uint64_t{text.size()} * 8;
  for (size_t i = 0; i < 8; ++i) all[all.size() - 1 - i] = static_cast<char>(bits >> 8 * i & 0xff);
  return all;
}

}  // namespace

std::array<uint8_t, 20> sha1(std::string_view text) {
  State state{0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476, 0xc3d2e1f0};
  const std::string all = padded(text);
  for (size_t start = 0; start < all.size(); start += 64) add_block(state, std::string_view(all).substr(start, 64));
  std::array<uint8_t, 20> digest{};
  for (size_t i = 0; i < digest.size(); ++i)
    digest[i] = static_cast<uint8_t>(state[i / 4] >> (24 - 8 * (i % 4)) & 0xff);
  return digest;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t start = 0; start < bytes.size(); start += 3) {
    const std::string_view group = bytes.substr(start, 3);
    uint32_t bits = 0;
    for (size_t i = 0; i < 3; ++i) bits = bits << 8 | (i < group.size() ? static_cast<uint8_t>(group[i]) : 0U);
    for (size_t i = 0; i < 4; ++i) text += i > group.size() ? '=' : kDigits[bits >> (18 - 6 * i) & 63];
  }
  return text;
}

}  // namespace surfcast::client
