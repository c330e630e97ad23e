#include "net/proxy_header.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "protocol/parse.h"

namespace surfcast::net {
namespace {

namespace ip = boost::asio::ip;

constexpr std::array<uint8_t, 12> kSignature{0x0d, 0x0a, 0x0d, 0x0a, 0x00, 0x0d, 0x0a, 0x51, 0x55, 0x49, 0x54, 0x0a};
constexpr size_t kMaxRest = 536;  // fits into one segment of TCP, as the specification wants
constexpr uint8_t kLocal = 0x20;  // version 2, and its commands
constexpr uint8_t kProxied = 0x21;
constexpr uint8_t kTcp4 = 0x11;
constexpr uint8_t kTcp6 = 0x21;

uint8_t byte_at(std::span<const std::byte> bytes, size_t place) {
  return std::to_integer<uint8_t>(bytes[place]);
}

bool is_port(std::string_view text) {
  const auto port = protocol::parse_unsigned(text);
  return port && *port <= 65535;
}

/// The parts of a text between single blanks.
std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (size_t end = text.find(' '); end != std::string_view::npos; end = text.find(' ')) {
    words.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  words.push_back(text);
  return words;
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

ProxyVersion proxy_version(std::span<const std::byte, kProxyProbeBytes> first) {
  constexpr std::string_view kLine = "PROXY ";
  if (std::memcmp(first.data(), kLine.data(), first.size()) == 0) return ProxyVersion::kText;
  // No protocol of this server begins with this byte.
  return byte_at(first, 0) == kSignature[0] ? ProxyVersion::kBinary : ProxyVersion::kNone;
}

// PROXY TCP4 203.0.113.7 192.0.2.1 50000 7600 (2.1 of the specification)
Result<std::optional<ip::address>> client_of_proxy_line(std::string_view line) {
  const std::vector<std::string_view> words = words_of(line);
  const bool begun = words.size() >= 2 && words[0] == "PROXY";
  if (begun && words[1] == "UNKNOWN") return std::nullopt;
  if (!begun || words.size() != 6) return fail(ErrorKind::kInvalidInput, "the PROXY line is incomplete");
  boost::system::error_code of_client;
  boost::system::error_code of_proxy;
  const ip::address client = ip::make_address(std::string(words[2]), of_client);
  const ip::address proxy = ip::make_address(std::string(words[3]), of_proxy);
  const bool version4 = client.is_v4() && proxy.is_v4() && words[1] == "TCP4";
  const bool version6 = client.is_v6() && proxy.is_v6() && words[1] == "TCP6";
  if (of_client || of_proxy || (!version4 && !version6) || !is_port(words[4]) || !is_port(words[5])) {
    return fail(ErrorKind::kInvalidInput, "the PROXY line names no addresses of TCP");
  }
  return std::optional<ip::address>(client);
}

Result<size_t> proxy_rest_bytes(std::span<const std::byte> head) {
  const bool signed_so = std::ranges::equal(head.first(kSignature.size()), kSignature, {},
                                            [](std::byte byte) { return std::to_integer<uint8_t>(byte); });
  const uint8_t command = byte_at(head, 12);
  if (!signed_so || (command != kLocal && command != kProxied)) {
    return fail(ErrorKind::kInvalidInput, "this is no header of version 2 of the PROXY protocol");
  }
  const size_t rest = size_t{byte_at(head, 14)} << 8 | byte_at(head, 15);
  if (rest > kMaxRest) return fail(ErrorKind::kLimit, "the PROXY header is too long");
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
