#include "protocol/framing.h"

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "protocol/framed.h"
#include "protocol/little_endian.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {
namespace {

using Bytes = std::vector<std::byte>;

wire::Request sample_request() {
  wire::Request request;
  request.set_id(77);
  wire::DrawPicture* picture = request.mutable_draw_picture();
  picture->set_model("cube");
  picture->mutable_camera()->mutable_position()->set_x(1.5);
  picture->mutable_camera()->mutable_focal_point()->set_z(-2);
  picture->mutable_resolution()->set_width(640);
  picture->mutable_resolution()->set_height(480);
  picture->set_spacing(0.25);
  return request;
}

Bytes header_of(uint32_t length) {
  Bytes header(kFrameHeaderBytes);
  store_u32(header.data(), length);
  return header;
}

TEST(Framing, AMessageComesBackWhole) {
  const wire::Request sent = sample_request();
  FrameSplitter splitter(kMaxRequestBytes);
  splitter.append(framed(sent));
  const auto frame = splitter.next();
  ASSERT_TRUE(frame && *frame);
  wire::Request received;
  ASSERT_TRUE(decode_message(**frame, received));
  EXPECT_EQ(received.SerializeAsString(), sent.SerializeAsString());
  EXPECT_FALSE(splitter.next()->has_value());
}

TEST(Framing, TheLengthIsFourBytesLeastSignificantFirst) {
  wire::Request request;
  request.set_id(1);
  const Bytes frame = framed(request);
  EXPECT_EQ(frame, (Bytes{std::byte{2}, std::byte{0}, std::byte{0}, std::byte{0}, std::byte{8}, std::byte{1}}));
}

TEST(Framing, AMessageCutAnywhereIsIncompleteUntilTheRestArrives) {
  const Bytes frame = framed(sample_request());
  for (size_t cut = 0; cut < frame.size(); ++cut) {
    FrameSplitter splitter(kMaxRequestBytes);
    splitter.append(std::span(frame).first(cut));
    const auto early = splitter.next();
    ASSERT_TRUE(early);
    EXPECT_FALSE(early->has_value()) << cut;
    splitter.append(std::span(frame).subspan(cut));
    EXPECT_TRUE(splitter.next()->has_value()) << cut;
  }
}

TEST(Framing, ManyMessagesArrivingByteByByteAreAllFound) {
  Bytes stream;
  for (uint64_t id = 1; id <= 5; ++id) {
    wire::Request request = sample_request();
    request.set_id(id);
    const Bytes frame = framed(request);
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  FrameSplitter splitter(kMaxRequestBytes);
  uint64_t found = 0;
  for (const std::byte byte : stream) {
    splitter.append(std::span(&byte, 1));
    const auto frame = splitter.next();
    ASSERT_TRUE(frame);
    if (!*frame) continue;
    wire::Request request;
    ASSERT_TRUE(decode_message(**frame, request));
    EXPECT_EQ(request.id(), ++found);
  }
  EXPECT_EQ(found, 5u);
}

TEST(Framing, AMessageOfNoBytesIsAMessage) {
  FrameSplitter splitter(kMaxRequestBytes);
  splitter.append(header_of(0));
  const auto frame = splitter.next();
  ASSERT_TRUE(frame && *frame);
  EXPECT_TRUE((*frame)->empty());
}

TEST(Framing, ALengthBeyondTheLimitIsAnErrorBeforeAnyOfItArrives) {
  for (const uint32_t length : {uint32_t{kMaxRequestBytes} + 1, 0x7fffffffU, 0x80000000U, 0xffffffffU}) {
    FrameSplitter splitter(kMaxRequestBytes);
    splitter.append(header_of(length));
    const auto frame = splitter.next();
    ASSERT_FALSE(frame) << length;
    EXPECT_EQ(frame.error().kind, ErrorKind::kLimit);
  }
}

TEST(Framing, ALengthAtTheLimitIsFine) {
  FrameSplitter splitter(kMaxRequestBytes);
  splitter.append(header_of(kMaxRequestBytes));
  splitter.append(Bytes(kMaxRequestBytes));
  EXPECT_EQ(splitter.next()->value().size(), kMaxRequestBytes);
}

TEST(Framing, AMessageLargerThanTheLimitIsNotSent) {
  wire::Answer answer;
  answer.mutable_picture()->set_data(std::string(2000, 'x'));
  const auto frame = encode_message(answer, 1000);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kLimit);
}

TEST(Framing, EveryTruncatedMessageDecodesOrFailsAndNeverCrashes) {
  const std::string whole = sample_request().SerializeAsString();
  int failures = 0;
  for (size_t length = 0; length < whole.size(); ++length) {
    wire::Request request;
    if (!decode_message(std::as_bytes(std::span(whole.data(), length)), request)) ++failures;
  }
  EXPECT_GT(failures, 0);
}

TEST(Framing, MutatedMessagesDecodeOrFailAndNeverCrash) {
  const std::string whole = sample_request().SerializeAsString();
  std::mt19937 random(3);
  int failures = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string mutated = whole;
    for (int change = 0; change < 3; ++change) mutated[random() % mutated.size()] = static_cast<char>(random());
    wire::Request request;
    if (!decode_message(std::as_bytes(std::span(mutated.data(), mutated.size())), request)) ++failures;
  }
  EXPECT_GT(failures, 100);
}

TEST(Framing, RandomStreamsEndInAnErrorOrWaitAndNeverCrash) {
  std::mt19937 random(5);
  for (int round = 0; round < 500; ++round) {
    FrameSplitter splitter(kMaxRequestBytes);
    Bytes bytes(random() % 300);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % 4 == 0 ? random() : 0);
    splitter.append(bytes);
    for (auto frame = splitter.next(); frame && *frame; frame = splitter.next()) {
      wire::Request request;
      const Status status = decode_message(**frame, request);
      EXPECT_TRUE(status || status.error().kind == ErrorKind::kInvalidInput);
    }
  }
}

}  // namespace
}  // namespace surfcast::protocol
