#include "base/letter_case.h"

#include <gtest/gtest.h>

namespace surfcast {
namespace {

TEST(LetterCaseTest, OnlyTheLettersAToZChange) {
  EXPECT_EQ(to_lower("LAZ_1.4 [@`{"), "laz_1.4 [@`{");
  EXPECT_EQ(to_lower("\xC3\x84\xC4\xB0"), "\xC3\x84\xC4\xB0");  // letters of UTF-8 beyond ASCII
  EXPECT_EQ(to_lower(std::string_view("A\0B", 3)), std::string_view("a\0b", 3));
}

TEST(LetterCaseTest, WordsAreEqualInAnyCaseIfTheyAreInLowerCase) {
  EXPECT_TRUE(equal_in_any_case("WebSocket", "websocket"));
  EXPECT_TRUE(equal_in_any_case("", ""));
  EXPECT_FALSE(equal_in_any_case("close", "closed"));
  EXPECT_FALSE(equal_in_any_case("@", "`"));  // they differ by the bit that letters differ by
}

TEST(LetterCaseTest, AnExtensionIsTheLastOneWithItsDot) {
  EXPECT_EQ(lower_extension("A.COPC.LAZ"), ".laz");
  EXPECT_EQ(lower_extension("a/b.c/README"), "");
  EXPECT_EQ(lower_extension(".hidden"), "");
}

}  // namespace
}  // namespace surfcast
