#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

#include "net/certificates.h"
#include "net/client_name.h"
#include "net/net_fixture.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// What a program writes on standard output.
std::string output_of(const std::string& command) {
  FILE* const pipe = ::popen(command.c_str(), "r");
  std::string all;
  std::array<char, 4096> buffer{};
  while (const size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) all.append(buffer.data(), count);
  ::pclose(pipe);
  return all;
}

/// A server with a certificate for localhost and 127.0.0.1.
class TlsTest : public NetFixture {
 protected:
  void SetUp() override {
    const std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(::testing::TempDir()) / (test + "_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    config_.tls = make_certificate(folder_);
  }
  void TearDown() override {
    NetFixture::TearDown();
    fs::remove_all(folder_);
  }

  [[nodiscard]] Result<client::ServerConnection> open(bool websocket, const fs::path& ca,
                                                      const std::string& host = "127.0.0.1") const {
    return client::ServerConnection::open(
        {.host = host, .port = port_, .websocket = websocket, .encrypted = true},
        {.connect = milliseconds(10'000), .answer = milliseconds(20'000), .ca = ca.string()});
  }
  [[nodiscard]] std::string s_client(const std::string& flags) const {
    return output_of("echo | openssl s_client -connect 127.0.0.1:" + std::to_string(port_) + " " + flags + " 2>&1");
  }
  /// A copy of the certificate, which the next one does not replace.
  [[nodiscard]] fs::path copy_of_certificate(const std::string& name) const {
    fs::copy_file(config_.tls.certificate, folder_ / name);
    return folder_ / name;
  }

  fs::path folder_;
  ServerConfig config_;
};

TEST_F(TlsTest, DrawsOverBothTransports) {
  start(config_);
  for (const bool websocket : {false, true}) {
    for (const std::string host : {"127.0.0.1", "localhost"}) {
      auto connection = open(websocket, config_.tls.certificate, host);
      ASSERT_TRUE(connection) << connection.error().message;
      const auto answer = connection->ask(picture_request("noise", 256, 256));
      ASSERT_TRUE(answer) << answer.error().message;
      EXPECT_EQ(answer->picture().resolution().width(), 256U);
    }
  }
}

TEST_F(TlsTest, AnswersHttpOnTheSamePort) {
  start(config_);
  const std::string request = "printf 'GET /api/models HTTP/1.1\\r\\nHost: here\\r\\nConnection: close\\r\\n\\r\\n'";
  const std::string answer =
      output_of(request + " | openssl s_client -quiet -connect 127.0.0.1:" + std::to_string(port_) + " 2> /dev/null");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("cube"));
  EXPECT_THAT(get("/api/models"), HasSubstr("cube")) << "this machine may do without";
}

/// A cookie of a browser that came through TLS is sent back through TLS alone.
TEST_F(TlsTest, TheConnectionTellsWhetherItsCookiesAreSecure) {
  start(config_);
  const auto request = [](const std::string& headers) {
    return "POST /api/logout HTTP/1.1\r\nHost: here\r\n" + headers + "Content-Length: 6\r\n\r\ntoken=";
  };
  const auto through_tls = [&](const std::string& headers) {
    std::ofstream(folder_ / "request") << request(headers);
    return output_of("openssl s_client -quiet -connect 127.0.0.1:" + std::to_string(port_) + " < " +
                     (folder_ / "request").string() + " 2> /dev/null");
  };
  const std::string secure = "Set-Cookie: __Host-surfcast=; Path=/; HttpOnly; SameSite=Strict; Secure";
  EXPECT_THAT(through_tls(""), HasSubstr(secure));
  EXPECT_THAT(through_tls("X-Forwarded-Proto: http\r\n"), HasSubstr(secure)) << "a client cannot say otherwise";
  EXPECT_THAT(through_tls("Origin: https://here\r\n"), HasSubstr(secure));
  EXPECT_THAT(through_tls("Origin: http://here\r\nX-Forwarded-Proto: http\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(http(request("")), HasSubstr("Set-Cookie: surfcast=;"));
  EXPECT_THAT(http(request("X-Forwarded-Proto: https\r\n")), HasSubstr(secure)) << "a proxy speaks TLS";
}

TEST_F(TlsTest, AServerThatIsNotTrustedIsNotTalkedTo) {
  start(config_);
  const auto unknown = open(false, "");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("the server's certificate is not trusted: self"));
}

TEST_F(TlsTest, ACertificateOfAnotherNameIsNotTrusted) {
  config_.tls = make_certificate(folder_, "DNS:elsewhere.example,IP:10.0.0.1");
  start(config_);
  for (const std::string host : {"127.0.0.1", "localhost"}) {
    const auto other = open(true, config_.tls.certificate, host);
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, HasSubstr("mismatch"));
  }
}

TEST_F(TlsTest, AServerWithoutTlsIsNamedAsSuch) {
  start();
  const auto plain = open(false, config_.tls.certificate);
  ASSERT_FALSE(plain);
  EXPECT_THAT(plain.error().message, HasSubstr("the server does not speak TLS"));
}

TEST_F(TlsTest, OldVersionsAndCiphersWithoutForwardSecrecyAreRefused) {
  start(config_);
  EXPECT_THAT(s_client("-tls1_3"), HasSubstr("TLSv1.3"));
  EXPECT_THAT(s_client("-tls1_2"), HasSubstr("ECDHE-ECDSA-"));
  EXPECT_THAT(s_client("-tls1_1 -cipher DEFAULT@SECLEVEL=0"), HasSubstr("alert protocol version"));
  EXPECT_THAT(s_client("-tls1_2 -cipher AES128-GCM-SHA256:ECDHE-ECDSA-AES128-SHA"),
              HasSubstr("alert handshake failure"));
}

TEST_F(TlsTest, ANewCertificateIsTakenWhileConnectionsStay) {
  start(config_);
  const fs::path former = copy_of_certificate("former.pem");
  auto connection = open(false, former);
  ASSERT_TRUE(connection);
  make_certificate(folder_);
  ASSERT_TRUE(eventually([&] { return open(false, config_.tls.certificate).has_value(); }));
  EXPECT_FALSE(open(false, former));
  EXPECT_TRUE(connection->ask(ping_request()));
}

TEST_F(TlsTest, ANewCertificateThatCannotBeUsedLeavesTheFormer) {
  start(config_);
  const fs::path former = copy_of_certificate("former.pem");
  std::ofstream(config_.tls.certificate) << "nonsense";
  ASSERT_TRUE(eventually([this] { return metric("surfcast_tls_reloads_failed_total") > 0; }));
  EXPECT_TRUE(open(false, former));
  EXPECT_GT(metric("surfcast_tls_certificate_expires_seconds"), 1'700'000'000);
}

TEST_F(TlsTest, ASilentHandshakeEndsInTime) {
  config_.hello = milliseconds(100);
  start(config_);
  RawSocket socket(port_);
  socket.send(std::string_view("\x16\x03\x01", 3));
  EXPECT_TRUE(socket.closed_within(milliseconds(20'000)));
}

TEST(CertificateTest, IsFoundByTheNamesOfKubernetesAndOfCertbot) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("certificate_names_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  EXPECT_FALSE(tls::find_certificate(folder, ""));
  std::ofstream(folder / "fullchain.pem") << "";
  EXPECT_EQ(tls::find_certificate(folder, "")->key, folder / "privkey.pem");
  std::ofstream(folder / "tls.crt") << "";
  EXPECT_EQ(tls::find_certificate(folder, "")->key, folder / "tls.key");
  EXPECT_FALSE(tls::find_certificate("", "key.pem"));
  EXPECT_FALSE(tls::find_certificate("certificate.pem", ""));
  EXPECT_TRUE(tls::find_certificate("", "")->certificate.empty());
  fs::remove_all(folder);
}

TEST(ClientNameTest, TellsTheLoopbackFromOthers) {
  using boost::asio::ip::make_address;
  for (const char* own : {"127.0.0.1", "127.3.2.1", "::1", "::ffff:127.0.0.1"})
    EXPECT_TRUE(is_loopback(make_address(own)));
  for (const char* other : {"10.0.0.1", "::ffff:10.0.0.1", "2001:db8::1"})
    EXPECT_FALSE(is_loopback(make_address(other)));
}

}  // namespace
}  // namespace surfcast::net
