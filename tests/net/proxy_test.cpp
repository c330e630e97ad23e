#include <array>
#include <string>
#include <vector>

#include "net/net_fixture.h"
#include "net/proxy_header.h"
#include "protocol/hello.h"

namespace surfcast::net {
namespace {

namespace ip = boost::asio::ip;

/// The header of a client at 203.0.113.`last`.
std::string header_of(char last, char command = 0x21) {
  std::string header("\r\n\r\n\0\r\nQUIT\n", 12);
  header += command;
  header += '\x11';
  header += std::string("\0\x0c", 2);
  header += std::string("\xcb\x00\x71", 3) + last + std::string("\x7f\0\0\1", 4) + std::string("\x30\x39\x1d\xb0", 4);
  return header;
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

TEST(ProxyHeaderTest, NamesTheAddressOfTheClient) {
  const std::string text = header_of(7);
  const auto head = bytes_of(text).first(kProxyHeadBytes);
  const auto rest = bytes_of(text).subspan(kProxyHeadBytes);
  ASSERT_EQ(proxy_rest_bytes(head).value_or(0), 12U);
  const auto client = client_of_proxy(head, rest);
  ASSERT_TRUE(client && *client);
  EXPECT_EQ((*client)->to_string(), "203.0.113.7");
  const auto local = client_of_proxy(bytes_of(header_of(7, 0x20)).first(kProxyHeadBytes), rest);
  EXPECT_TRUE(local && !*local) << "the proxy itself looks whether the server lives";
  EXPECT_FALSE(client_of_proxy(head, rest.first(11)));
}

TEST(ProxyHeaderTest, WhatIsNoneIsAnError) {
  for (size_t place = 0; place < 13; ++place) {
    std::string text = header_of(7);
    text[place] = static_cast<char>(text[place] ^ 0x40);
    EXPECT_FALSE(proxy_rest_bytes(bytes_of(text).first(kProxyHeadBytes))) << place;
  }
  std::string text = header_of(7);
  text[14] = '\xff';
  EXPECT_FALSE(proxy_rest_bytes(bytes_of(text).first(kProxyHeadBytes))) << "64 KiB";
}

TEST(ProxyHeaderTest, AreToldApartByTheirFirstBytes) {
  const auto version_of = [](const std::string& text) {
    return proxy_version(bytes_of(text).first<kProxyProbeBytes>());
  };
  EXPECT_EQ(version_of(header_of(7)), ProxyVersion::kBinary);
  EXPECT_EQ(version_of("PROXY TCP4"), ProxyVersion::kText);
  for (const char* other : {"PUT /api/uploads", "PROPFIND /", "PROXYx", "\xf5SURFCST"}) {
    EXPECT_EQ(version_of(other), ProxyVersion::kNone) << other;
  }
}

TEST(ProxyHeaderTest, ALineOfTextNamesTheAddressOfTheClient) {
  for (const auto& [line, client] :
       std::vector<std::pair<std::string, std::string>>{{"PROXY TCP4 203.0.113.7 192.0.2.1 50000 7600", "203.0.113.7"},
                                                        {"PROXY TCP6 2001:db8::7 ::1 50000 7600", "2001:db8::7"}}) {
    const auto named = client_of_proxy_line(line);
    ASSERT_TRUE(named && *named) << line;
    EXPECT_EQ((*named)->to_string(), client);
  }
  for (const char* unknown : {"PROXY UNKNOWN", "PROXY UNKNOWN ffff::1 ffff::2 65535 65535"}) {
    const auto named = client_of_proxy_line(unknown);
    EXPECT_TRUE(named && !*named) << unknown;
  }
}

TEST(ProxyHeaderTest, AWrongLineOfTextIsAnError) {
  for (const char* wrong :
       {"PROXY", "PROXY ", "PROXY TCP4", "PROXY TCP4 203.0.113.7 192.0.2.1 50000", "PROXY TCP4 203.0.113.7 ::1 1 2",
        "PROXY TCP6 203.0.113.7 192.0.2.1 1 2", "PROXY TCP4 203.0.113.7  192.0.2.1 1 2", "GET / HTTP/1.1 a b c",
        "PROXY TCP4 203.0.113 192.0.2.1 1 2", "PROXY TCP4 203.0.113.7 192.0.2.1 1 65536",
        "PROXY TCP4 203.0.113.7 192.0.2.1 -1 2", "PROXY TCP4 203.0.113.7 192.0.2.1 1 2 3"}) {
    EXPECT_FALSE(client_of_proxy_line(wrong)) << wrong;
  }
}

TEST(NetworksTest, ContainAddressesThatBeginAsTheyDo) {
  const auto networks = Networks::parse({"10.1.0.0/16", "192.0.2.4", "fd00::/8"});
  ASSERT_TRUE(networks);
  for (const char* inside : {"10.1.255.1", "192.0.2.4", "fdab::1", "::ffff:10.1.2.3"}) {
    EXPECT_TRUE(networks->contain(ip::make_address(inside))) << inside;
  }
  for (const char* outside : {"10.2.0.1", "192.0.2.5", "fe80::1", "::1"}) {
    EXPECT_FALSE(networks->contain(ip::make_address(outside))) << outside;
  }
  for (const char* wrong : {"10.1.0.0/33", "10.1", "fd00::/129", "", "10.1.0.0/"}) {
    EXPECT_FALSE(Networks::parse({wrong})) << wrong;
  }
}

/// A server behind a proxy at 127.0.0.1, and two connections for each client.
class ProxyTest : public NetFixture {
 protected:
  void SetUp() override {
    config_.trusted_proxies = *Networks::parse({"127.0.0.1"});
    config_.clients.connections_per_client = 2;
  }
  ServerConfig config_;
};

constexpr std::string_view kReady = "GET /api/models HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n";

TEST_F(ProxyTest, LimitsAreThoseOfTheClientThatTheProxyNames) {
  start(config_);
  std::vector<RawSocket> held;
  for (int i = 0; i < 2; ++i) {
    held.emplace_back(port_);
    ASSERT_TRUE(held.back().send(header_of(7)));
  }
  ASSERT_TRUE(eventually([&] {
    RawSocket third(port_);
    third.send(header_of(7) + std::string(kReady));
    return third.read_http().substr(9, 3) == "503";
  }));
  RawSocket other(port_);
  other.send(header_of(8) + std::string(kReady));
  EXPECT_EQ(other.read_http().substr(9, 3), "200");
}

TEST_F(ProxyTest, ALineOfTextCountsTheSame) {
  start(config_);
  const std::vector<std::byte> hello = protocol::encode_hello(protocol::make_hello("test"));
  std::vector<RawSocket> held;
  for (int i = 0; i < 2; ++i) {
    held.emplace_back(port_);
    held.back().send("PROXY TCP4 203.0.113.7 127.0.0.1 50000 7600\r\n");
    held.back().send(hello);
    ASSERT_EQ(held.back().read_exactly(hello.size()).size(), hello.size());
  }
  RawSocket third(port_);
  third.send(header_of(7) + std::string(kReady));
  EXPECT_EQ(third.read_http().substr(9, 3), "503");
  RawSocket other(port_);
  for (const char byte : "PROXY TCP6 2001:db8::7 ::1 1 2\r\n" + std::string(kReady)) other.send(std::string(1, byte));
  EXPECT_EQ(other.read_http().substr(9, 3), "200");
}

TEST_F(ProxyTest, ALineOfTextThatDoesNotEndEndsTheConnection) {
  start(config_);
  RawSocket endless(port_);
  endless.send("PROXY UNKNOWN " + std::string(200, 'x'));
  EXPECT_TRUE(endless.closed_within(RawSocket::kPatience));
  RawSocket wrong(port_);
  wrong.send("PROXY TCP4 nobody\r\n" + std::string(kReady));
  EXPECT_EQ(wrong.read_to_end(), "");
}

TEST_F(ProxyTest, AProxyMaySpeakForItself) {
  start(config_);
  EXPECT_EQ(get("/healthz").substr(9, 3), "200");
  RawSocket local(port_);
  local.send(header_of(7, 0x20) + std::string(kReady));
  EXPECT_EQ(local.read_http().substr(9, 3), "200");
  RawSocket wrong(port_);
  wrong.send("\r\nGET / HTTP/1.1\r\n\r\n");
  EXPECT_EQ(wrong.read_to_end(), "");
}

TEST_F(ProxyTest, NobodyElseNamesAnotherAddress) {
  config_.trusted_proxies = *Networks::parse({"127.0.0.9"});
  start(config_);
  RawSocket stranger(port_);
  stranger.send(header_of(7) + std::string(kReady));
  EXPECT_EQ(stranger.read_to_end().find(" 200 "), std::string::npos);
}

TEST_F(ProxyTest, AHeaderThatDoesNotComeEndsTheConnection) {
  config_.hello = milliseconds(50);
  start(config_);
  RawSocket slow(port_);
  slow.send(header_of(7).substr(0, 20));
  EXPECT_TRUE(slow.closed_within(RawSocket::kPatience));
}

}  // namespace
}  // namespace surfcast::net
