#include "client/websocket_stream.h"

#include <string>

#include <gtest/gtest.h>

#include "client/sha1.h"

namespace surfcast::client {
namespace {

std::string hex(const std::array<uint8_t, 20>& digest) {
  std::string text;
  for (const uint8_t byte : digest) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

TEST(Sha1, DigestsAreThoseOfTheStandard) {
  EXPECT_EQ(hex(sha1("")), "da39a3ee5e6b4b0d3255bfef95601890afd80709");
  EXPECT_EQ(hex(sha1("abc")), "a9993e364706816aba3e25717850c26c9cd0d89d");
  EXPECT_EQ(hex(sha1("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "84983e441c3bd26ebaae4aa1f95129e5e54670f1");
  EXPECT_EQ(hex(sha1(std::string(1'000'000, 'a'))), "34aa973cd4c4daa4f61eeb2bdbad27316534016f");
}

TEST(Base64, GroupsOfEverySizeAreThoseOfTheStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(WebSocketHandshake, OnlyTheRightAnswerIsAccepted) {
  const auto handshake = WebSocketHandshake::make("here:7600", "the sample nonce");
  EXPECT_NE(handshake.request.find("Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"), std::string::npos);
  const std::string granted = "HTTP/1.1 101 Switching Protocols\r\nsec-websocket-ACCEPT:  ";
  EXPECT_TRUE(handshake.check(granted + "s3pPLMBiTxaQ9kYGzzhZRbK+xOo= \r\n\r\n"));
  EXPECT_FALSE(handshake.check(granted + "S3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n\r\n"));
  EXPECT_FALSE(handshake.check("HTTP/1.1 101 Switching Protocols\r\n\r\n"));
  const Status refused = handshake.check("HTTP/1.1 403 Forbidden\r\n\r\n");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("403 Forbidden"), std::string::npos);
}

/// A stream that has been told these bytes, perhaps one at a time.
std::unique_ptr<MessageStream> told(const std::string& bytes) {
  auto stream = make_websocket_stream();
  stream->append(std::as_bytes(std::span(bytes)));
  return stream;
}

std::string text_of(const Result<std::optional<MessageStream::Bytes>>& message) {
  if (!message) return "error: " + message.error().message;
  if (!*message) return "incomplete";
  return {reinterpret_cast<const char*>((*message)->data()), (*message)->size()};
}

using namespace std::string_literals;

TEST(WebSocketStream, MessagesComeOutWhole) {
  const auto stream = told("\x82\x03one\x02\x01t\x00\x00\x80\x02wo"s);
  EXPECT_EQ(text_of(stream->next()), "one");
  EXPECT_EQ(text_of(stream->next()), "two");
  EXPECT_EQ(text_of(stream->next()), "incomplete");
}

TEST(WebSocketStream, BytesMayComeOneByOne) {
  const std::string bytes = "\x02\x7e\x01\x00"s + std::string(256, 'x') + "\x80\x01y"s;
  const auto stream = make_websocket_stream();
  for (size_t i = 0; i < bytes.size(); ++i) {
    EXPECT_EQ(text_of(stream->next()), "incomplete");
    stream->append(std::as_bytes(std::span(bytes).subspan(i, 1)));
  }
  EXPECT_EQ(text_of(stream->next()), std::string(256, 'x') + "y");
}

TEST(WebSocketStream, PingsBetweenPiecesAreAnswered) {
  const auto stream = told(
      "\x02\x01"
      "a"
      "\x89\x02hi\x80\x01"
      "b"s);
  EXPECT_EQ(text_of(stream->next()), "ab");
  const auto reply = stream->take_replies();
  ASSERT_EQ(reply.size(), 8u);
  EXPECT_EQ(reply[0], std::byte{0x8a});
  EXPECT_EQ(reply[1], std::byte{0x82});
  EXPECT_EQ(reply[6] ^ reply[2], std::byte{'h'});
  EXPECT_TRUE(stream->take_replies().empty());
}

TEST(WebSocketStream, WhatAServerMustNotSendIsAnError) {
  for (const std::string& wrong : {"\x82\x83"
                                   "abcdone"s,
                                   "\x81\x04text"s, "\xc2\x01x"s, "\x80\x01x"s, "\x02\x01x\x82\x01x"s, "\x83\x01x"s,
                                   "\x82\x7f\x00\x00\x00\x00\x20\x00\x00\x01"s}) {
    EXPECT_EQ(text_of(told(wrong)->next()).substr(0, 5), "error") << wrong;
  }
  EXPECT_EQ(text_of(told("\x88\x02\x03\xe8"s)->next()), "error: the server closed the connection");
}

}  // namespace
}  // namespace surfcast::client
