#include "base/ascii_text.h"

#include <gtest/gtest.h>

namespace surfcast {
namespace {

TEST(AsciiTextTest, OnlyTheLettersAToZChange) {
  EXPECT_EQ(to_lower("LAZ_1.4 [@`{"), "laz_1.4 [@`{");
  EXPECT_EQ(to_lower("\xC3\x84\xC4\xB0"), "\xC3\x84\xC4\xB0");  // letters of UTF-8 beyond ASCII
  EXPECT_EQ(to_lower(std::string_view("A\0B", 3)), std::string_view("a\0b", 3));
}

TEST(AsciiTextTest, WordsAreEqualInAnyCaseIfTheyAreInLowerCase) {
  EXPECT_TRUE(equal_in_any_case("WebSocket", "websocket"));
  EXPECT_TRUE(equal_in_any_case("", ""));
  EXPECT_FALSE(equal_in_any_case("close", "closed"));
  EXPECT_FALSE(equal_in_any_case("@", "`"));  // they differ by the bit that letters differ by
}

TEST(AsciiTextTest, AnExtensionIsTheLastOneWithItsDot) {
  EXPECT_EQ(lower_extension("A.COPC.LAZ"), ".laz");
  EXPECT_EQ(lower_extension("a/b.c/README"), "");
  EXPECT_EQ(lower_extension(".hidden"), "");
}

TEST(AsciiTextTest, WhiteSpaceIsTakenFromBothEndsOnly) {
  EXPECT_EQ(trimmed(" \t\r\n\v\fa b\t c \r\n"), "a b\t c");
  EXPECT_EQ(trimmed("a"), "a");
  EXPECT_EQ(trimmed(" \n "), "");
  EXPECT_EQ(trimmed(""), "");
  EXPECT_EQ(trimmed("\xC2\xA0"
                    "a"),
            "\xC2\xA0"
            "a");  // a no-break space of UTF-8 is no white space of ASCII
}

}  // namespace
}  // namespace surfcast
