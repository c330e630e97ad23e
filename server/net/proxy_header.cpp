#include "net/proxy_header.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "protocol/parse.h"

namespace surfcast::net {
namespace {

namespace ip = boost::asio::ip;

constexpr std::array<uint8_t, 12> kSignature{0x0d, 0x0a, 0x0d, 0x0a, 0x00, 0x0d, 0x0a, 0x51, 0x55, 0x49, 0x54, 0x0a};
constexpr size_t kMostRest = 536;  // fits into one segment of TCP, as the specification wants
constexpr uint8_t kLocal = 0x20;   // version 2, and its commands
constexpr uint8_t kProxied = 0x21;
constexpr uint8_t kTcp4 = 0x11;
constexpr uint8_t kTcp6 = 0x21;

uint8_t byte_at(std::span<const std::byte> bytes, size_t place) {
  return std::to_integer<uint8_t>(bytes[place]);
}

template <typename Address>
Result<std::optional<ip::address>> address_in(std::span<const std::byte> rest) {
  typename Address::bytes_type bytes{};
  const size_t with_ports = 2 * bytes.size() + 4;
  if (rest.size() < with_ports) return fail(ErrorKind::kInvalidInput, "the PROXY header is too short");
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = byte_at(rest, i);
  return std::optional<ip::address>(Address(bytes));
}

ip::address_v6 mapped(const ip::address& address) {
  return address.is_v4() ? ip::make_address_v6(ip::v4_mapped, address.to_v4()) : address.to_v6();
}

bool same_beginning(const ip::address_v6::bytes_type& a, const ip::address_v6::bytes_type& b, unsigned bits) {
  for (size_t i = 0; i < a.size() && bits > 0; ++i) {
    const unsigned here = std::min(bits, 8U);
    if (((a[i] ^ b[i]) >> (8 - here)) != 0) return false;
    bits -= here;
  }
  return true;
}

}  // namespace

Result<size_t> proxy_rest_bytes(std::span<const std::byte> head) {
  const bool signed_so = std::ranges::equal(head.first(kSignature.size()), kSignature, {},
                                            [](std::byte byte) { return std::to_integer<uint8_t>(byte); });
  const uint8_t command = byte_at(head, 12);
  if (!signed_so || (command != kLocal && command != kProxied)) {
    return fail(ErrorKind::kInvalidInput, "this is no header of version 2 of the PROXY protocol");
  }
  const size_t rest = size_t{byte_at(head, 14)} << 8 | byte_at(head, 15);
  if (rest > kMostRest) return fail(ErrorKind::kLimit, "the PROXY header is too long");
  return rest;
}

Result<std::optional<ip::address>> client_of_proxy(std::span<const std::byte> head, std::span<const std::byte> rest) {
  if (byte_at(head, 12) == kLocal) return std::nullopt;
  if (byte_at(head, 13) == kTcp4) return address_in<ip::address_v4>(rest);
  if (byte_at(head, 13) == kTcp6) return address_in<ip::address_v6>(rest);
  return fail(ErrorKind::kUnsupported, "the PROXY header names no address of TCP");
}

Result<Networks> Networks::parse(const std::vector<std::string>& texts) {
  Networks result;
  for (const std::string& text : texts) {
    const size_t slash = text.find('/');
    boost::system::error_code code;
    const ip::address address = ip::make_address(text.substr(0, slash), code);
    const unsigned whole = address.is_v4() ? 32 : 128;
    const auto bits = slash == std::string::npos ? whole : protocol::parse_unsigned(text.substr(slash + 1));
    if (code || !bits || *bits > whole) return fail(ErrorKind::kInvalidInput, text + " is no network");
    result.networks_.push_back({mapped(address), *bits + 128 - whole});
  }
  return result;
}

bool Networks::contain(const ip::address& address) const {
  return std::ranges::any_of(networks_, [bytes = mapped(address).to_bytes()](const Network& network) {
    return same_beginning(network.address.to_bytes(), bytes, network.bits);
  });
}

}  // namespace surfcast::net
