#include "protocol/hello.h"

#include <string>

#include <gtest/gtest.h>

#include "protocol/errors.h"
#include "protocol/little_endian.h"

namespace surfcast::protocol {
namespace {

TEST(Hello, ComesBackAsItWasSent) {
  Hello hello = make_hello("surfcastd");
  hello.version = {3, 9};
  hello.status = HelloStatus::kBusy;
  hello.message = "come back later";
  const Result<Hello> decoded = decode_hello(encode_hello(hello));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->version, hello.version);
  EXPECT_EQ(decoded->status, HelloStatus::kBusy);
  EXPECT_EQ(decoded->program, hello.program);
  EXPECT_EQ(decoded->message, hello.message);
}

TEST(Hello, TheLayoutIsTheOneThatEveryVersionReads) {
  Hello hello;
  hello.version = {1, 2};
  hello.program = "p";
  hello.message = "mm";
  const std::vector<std::byte> bytes = encode_hello(hello);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  EXPECT_EQ(text, std::string("\xf5SURFCST\x01\x00\x02\x00\x00\x00\x01\x00\x02\x00pmm", 21));
}

TEST(Hello, OfAClientNamesItsModelAsOneWord) {
  EXPECT_EQ(make_client_hello("surfcast", "").program, make_hello("surfcast").program);
  EXPECT_EQ(make_client_hello("surfcast", "old church=1").program,
            make_hello("surfcast").program + " model=old%20church%3D1");
}

TEST(Hello, NoMethodOfHttpBeginsWithItsFirstByte) {
  EXPECT_GE(kHelloMagic[0], 0x80);
}

TEST(Hello, EveryTruncationIsAnError) {
  const std::vector<std::byte> whole = encode_hello(make_hello("surfcast"));
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(decode_hello(std::span(whole).first(length))) << length;
  }
}

TEST(Hello, BytesBehindItAreAnError) {
  std::vector<std::byte> bytes = encode_hello(make_hello("surfcast"));
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode_hello(bytes));
}

TEST(Hello, AnotherProtocolIsToldApart) {
  const std::string http = "HTTP/1.1 400 Bad Request\r\n";
  const Result<Hello> hello = decode_hello(std::as_bytes(std::span(http.data(), http.size())));
  ASSERT_FALSE(hello);
  EXPECT_EQ(hello.error().kind, ErrorKind::kUnsupported);
}

TEST(Hello, TextsLongerThanTheLimitAreRefusedBeforeTheyAreRead) {
  std::vector<std::byte> bytes = encode_hello(make_hello("surfcast"));
  store_u16(&bytes[16], 0xffff);
  EXPECT_FALSE(hello_text_bytes(std::span(bytes).first<kHelloHeaderBytes>()));
}

TEST(Hello, TextsThatAreTooLongAreCutWhenSent) {
  Hello hello;
  hello.message = std::string(5000, 'x');
  const Result<Hello> decoded = decode_hello(encode_hello(hello));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->message.size(), kMaxHelloTextBytes);
}

TEST(Hello, ControlCharactersOfAPeerDoNotReachATerminal) {
  Hello hello;
  hello.program = "evil\x1b[2J\n";
  const Result<Hello> decoded = decode_hello(encode_hello(hello));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->program, "evil [2J ");
}

TEST(Hello, AServerRefusesAnotherMajorVersionAndNamesBoth) {
  for (const uint16_t major : {uint16_t{0}, uint16_t{2}, uint16_t{65535}}) {
    Hello client = make_hello("surfcast");
    client.version = {major, 4};
    const Hello answer = answer_hello(client, "surfcastd");
    EXPECT_EQ(answer.status, HelloStatus::kVersionRefused);
    EXPECT_NE(answer.message.find(std::to_string(major) + ".4"), std::string::npos);
  }
}

TEST(Hello, AServerWelcomesAnyMinorVersion) {
  Hello client = make_hello("surfcast");
  client.version.minor = 1000;
  EXPECT_EQ(answer_hello(client, "surfcastd").status, HelloStatus::kWelcome);
}

TEST(Hello, AClientExplainsAServerOfAnotherMajorVersion) {
  Hello server = make_hello("surfcastd");
  server.version = {2, 0};
  server.status = HelloStatus::kVersionRefused;
  const Status status = check_server_hello(server);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kUnsupported);
  EXPECT_NE(status.error().message.find("2.0"), std::string::npos);
}

TEST(Hello, AClientRepeatsWhyItIsRefusedAlsoForStatusesItDoesNotKnow) {
  Hello server = make_hello("surfcastd");
  server.status = static_cast<HelloStatus>(99);
  server.message = "full moon";
  const Status status = check_server_hello(server);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("full moon"), std::string::npos);
}

TEST(CleanUtf8, KeepsWhatIsWellFormedAndMarksTheRest) {
  EXPECT_EQ(clean_utf8("na\xc3\xafve \xe2\x82\xac \xf0\x9f\x98\x80"), "na\xc3\xafve \xe2\x82\xac \xf0\x9f\x98\x80");
  EXPECT_EQ(clean_utf8("caf\xe9"), "caf?");
  EXPECT_EQ(clean_utf8("\xc0\xaf"), "??");            // an overlong slash
  EXPECT_EQ(clean_utf8("\xed\xa0\x80"), "???");       // a surrogate
  EXPECT_EQ(clean_utf8("\xf4\x90\x80\x80"), "????");  // beyond Unicode
  EXPECT_EQ(clean_utf8(std::string_view("a\0b\n", 4)), "a b ");
  EXPECT_EQ(clean_utf8("\xe2\x82"), "??");  // cut short
}

}  // namespace
}  // namespace surfcast::protocol
