#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stream/base64_stream.h"
#include "stream/bzip2_stream.h"
#include "stream/inflate_stream.h"
#include "stream/memory_stream.h"
#include "stream/zstd_stream.h"
#include "support/packing.h"

namespace surfcast::stream {
namespace {

using ::testing::HasSubstr;
using testing::in_memory;
using testing::read_all;

struct Coding {
  std::string name;
  std::string (*pack)(std::string_view);
  std::function<StreamPtr(StreamPtr)> unpack;
  bool joins = true;  ///< packed data may follow packed data
};

StreamPtr inflate(StreamPtr source) {
  return std::make_unique<InflateStream>(std::move(source));
}

std::vector<Coding> codings() {
  return {{"gzip", testing::gzip, inflate},
          {"zlib", testing::zlib, inflate, false},
          {"bzip2", testing::bzip2, [](StreamPtr s) { return std::make_unique<Bzip2Stream>(std::move(s)); }},
          {"zstd", testing::zstd, [](StreamPtr s) { return std::make_unique<ZstdStream>(std::move(s)); }},
          {"base64", testing::base64, [](StreamPtr s) { return std::make_unique<Base64Stream>(std::move(s)); }}};
}

/// Bytes that compress somewhat.
std::string sample(size_t size) {
  std::string text;
  uint32_t state = 1;
  while (text.size() < size) {
    state = state * 1664525 + 1013904223;
    text += static_cast<char>(state >> 28);
  }
  return text;
}

TEST(DecodersTest, YieldWhatWasPackedForAnyPortions) {
  for (const Coding& coding : codings()) {
    for (const size_t size : {size_t{0}, size_t{1}, size_t{2}, size_t{3}, size_t{100001}}) {
      for (const size_t portion : {size_t{1}, size_t{7}, size_t{5000}}) {
        SCOPED_TRACE(coding.name + " " + std::to_string(size) + " " + std::to_string(portion));
        const std::string text = sample(size);
        const StreamPtr stream = coding.unpack(in_memory(coding.pack(text), portion));
        EXPECT_EQ(read_all(*stream, 3 * portion).value_or("failed"), text);
      }
    }
  }
}

TEST(DecodersTest, PartsPackedOneByOneFollowEachOther) {
  for (const Coding& coding : codings()) {
    if (!coding.joins) continue;
    SCOPED_TRACE(coding.name);
    const StreamPtr stream = coding.unpack(in_memory(coding.pack(sample(1000)) + coding.pack("tail"), 11));
    EXPECT_EQ(read_all(*stream).value_or("failed"), sample(1000) + "tail");
  }
}

TEST(DecodersTest, EveryTruncationFails) {
  for (const Coding& coding : codings()) {
    if (coding.name == "base64") continue;  // has no end of its own
    SCOPED_TRACE(coding.name);
    const std::string packed = coding.pack(sample(300));
    for (size_t size = 0; size < packed.size(); ++size) {
      const StreamPtr stream = coding.unpack(in_memory(packed.substr(0, size)));
      EXPECT_FALSE(read_all(*stream)) << size;
    }
  }
}

TEST(DecodersTest, DamagedChecksumsFail) {
  for (const Coding& coding : codings()) {
    if (coding.name == "base64" || coding.name == "zstd") continue;  // have none
    SCOPED_TRACE(coding.name);
    std::string packed = coding.pack(sample(300));
    packed[packed.size() - (coding.name == "gzip" ? 6 : 3)] ^= 1;
    const StreamPtr stream = coding.unpack(in_memory(packed));
    const Result<std::string> text = read_all(*stream);
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().kind, ErrorKind::kInvalidInput);
  }
}

TEST(DecodersTest, WhatTheyYieldIsNeverMoreThanTheySaid) {
  for (const Coding& coding : codings()) {
    SCOPED_TRACE(coding.name);
    const std::string zeros(3000000, '\0');  // the best case of every compressor
    const StreamPtr stream = coding.unpack(in_memory(coding.pack(zeros)));
    uint64_t left = zeros.size();
    std::string part(100000, '\1');
    while (left > 0) {
      ASSERT_GE(stream->at_most(), left);
      const Result<size_t> read = stream->read(std::as_writable_bytes(std::span(part)));
      ASSERT_TRUE(read);
      left -= *read;
    }
  }
}

TEST(DecodersTest, TenKilobytesOfDeflateCannotHoldAGigabyte) {
  const InflateStream stream(in_memory(std::string(10000, '\0')));
  EXPECT_LT(stream.at_most(), 11'000'000u);
}

TEST(DecodersTest, BytesBehindGzipAreIgnored) {
  const StreamPtr stream = inflate(in_memory(testing::gzip("text") + std::string(100, '\0'), 3));
  EXPECT_EQ(read_all(*stream).value_or("failed"), "text");
}

TEST(DecodersTest, WhatIsNotBase64Fails) {
  for (const char* text : {"QUJ", "Q", "QUJ!", "=UJD", "Q=JD", "QU=D", "QUJD\x01\x80\x80\x80"}) {
    Base64Stream stream(in_memory(text));
    EXPECT_FALSE(read_all(stream)) << text;
  }
  Base64Stream spaced(in_memory(" Q\nUJ\tD\r\n"));
  EXPECT_EQ(read_all(spaced).value_or("failed"), "ABC");
}

TEST(DecodersTest, SkippingPassesOverDecodedBytes) {
  const std::string text = sample(200000);
  for (const Coding& coding : codings()) {
    SCOPED_TRACE(coding.name);
    const StreamPtr stream = coding.unpack(in_memory(coding.pack(text)));
    ASSERT_TRUE(stream->skip(150001));
    EXPECT_EQ(read_all(*stream).value_or("failed"), text.substr(150001));
    const StreamPtr beyond = coding.unpack(in_memory(coding.pack(text)));
    const Status status = beyond->skip(text.size() + 1);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("truncated"));
  }
}

TEST(DecodersTest, AWindowAboveTheLimitIsRefused) {
  // Magic, a descriptor of a window alone, a window of 2^41 bytes, an empty last block (RFC 8878).
  ZstdStream stream(in_memory(std::string("\x28\xb5\x2f\xfd\x00\xf8\x01\x00\x00", 9)));
  const Result<std::string> text = read_all(stream);
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().message, HasSubstr("memory"));
}

}  // namespace
}  // namespace surfcast::stream
