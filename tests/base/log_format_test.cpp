#include "base/log_format.h"

#include <string>

#include <gtest/gtest.h>

namespace surfcast {
namespace {

TEST(LogFormatTest, NoValueEndsItsLineOrItsString) {
  EXPECT_EQ(json_escaped("a \"b\" \\ c"), "a \\\"b\\\" \\\\ c");
  EXPECT_EQ(json_escaped("a\nb\x1b[0m\x7f"), "a\\u000ab\\u001b[0m\\u007f");
  EXPECT_EQ(json_escaped(std::string("a\0b", 3)), "a\\u0000b");
}

TEST(LogFormatTest, WhatIsNotAsciiIsEscapedAndWhatIsNotUtf8IsReplaced) {
  EXPECT_EQ(json_escaped("\xc3\xa9"), "\\u00e9");
  EXPECT_EQ(json_escaped("\xe2\x80\xa8"), "\\u2028");
  EXPECT_EQ(json_escaped("\xf0\x9f\x98\x80"), "\\ud83d\\ude00");
  for (const std::string wrong : {"\xff", "\xc0\x80", "\xed\xa0\x80", "\xe2\x82"}) {
    EXPECT_EQ(json_escaped(wrong).substr(0, 6), "\\ufffd") << wrong;
  }
  EXPECT_EQ(json_escaped("\xe2\x82x"), "\\ufffd\\ufffdx");
}

}  // namespace
}  // namespace surfcast
