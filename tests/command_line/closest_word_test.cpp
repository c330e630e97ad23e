#include <array>

#include <gtest/gtest.h>

#include "command_line/parse_failure.h"

namespace surfcast::command_line {
namespace {

const std::array<std::string, 5> kCommands{"build", "inspect", "pick", "render", "serve"};

std::string closest(const char* typed) {
  return closest_word(typed, kCommands).value_or("");
}

TEST(ClosestWord, FindsWhatOneEditMakes) {
  EXPECT_EQ(closest("bild"), "build");
  EXPECT_EQ(closest("serves"), "serve");
  EXPECT_EQ(closest("rendor"), "render");
  EXPECT_EQ(closest("inpsect"), "inspect");
}

TEST(ClosestWord, TwoEditsAreTheMost) {
  EXPECT_EQ(closest("srvee"), "serve");
  EXPECT_EQ(closest("rnedre"), "render");
  EXPECT_EQ(closest("unspekk"), "");
}

TEST(ClosestWord, TheBeginningOfAWordIsEnough) {
  EXPECT_EQ(closest("insp"), "inspect");
  EXPECT_EQ(closest("r"), "render");
}

TEST(ClosestWord, ShortWordsAreNotAllAlike) {
  EXPECT_EQ(closest("xy"), "");
  EXPECT_EQ(closest(""), "");
}

}  // namespace
}  // namespace surfcast::command_line
