#include "scan/lzf.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/bytes.h"

namespace surfcast::scan {
namespace {

using testing::as_bytes;

std::optional<std::string> expand(std::string_view compressed, size_t size) {
  const auto bytes = decompress_lzf(as_bytes(compressed), size);
  return bytes ? std::optional(std::string(bytes->begin(), bytes->end())) : std::nullopt;
}

TEST(LzfTest, LiteralRunsAreCopied) {
  EXPECT_EQ(expand(std::string_view("\2abc\0d", 6), 4), "abcd");
}

TEST(LzfTest, ShortReferencesMayReachIntoWhatTheyWrite) {
  // "ab", then 2 + 3 bytes from 2 back.
  EXPECT_EQ(expand(std::string_view("\1ab\x60\1", 5), 7), "abababa");
}

TEST(LzfTest, LongReferencesAddTheNextByteToTheirLength) {
  // 'a', then 2 + 7 + 255 bytes from 1 back.
  EXPECT_EQ(expand(std::string_view("\0a\xE0\xFF\0", 5), 265), std::string(265, 'a'));
}

TEST(LzfTest, DamageIsRefused) {
  EXPECT_FALSE(expand(std::string_view("\2ab", 3), 3));               // run beyond the input
  EXPECT_FALSE(expand(std::string_view("\2abc", 4), 2));              // run beyond the output
  EXPECT_FALSE(expand(std::string_view("\2abc", 4), 4));              // too little output
  EXPECT_FALSE(expand(std::string_view("\0a\x20\1", 4), 4));          // before the beginning
  EXPECT_FALSE(expand(std::string_view("\0a\x60\0", 4), 4));          // reference beyond the output
  EXPECT_FALSE(expand(std::string_view("\0a\xE0", 3), 10));           // ends before the length
  EXPECT_FALSE(expand(std::string_view("\0a\x20", 3), 10));           // ends before the distance
  EXPECT_FALSE(expand(std::string_view("\0a", 2), size_t{1} << 60));  // more than can be expanded to
}

}  // namespace
}  // namespace surfcast::scan
