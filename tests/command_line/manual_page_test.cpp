#include "command_line/manual_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_line/sample_program.h"

namespace surfcast::command_line {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string sample_page() {
  const auto program = sample_program();
  return manual_page(summarize_command(*program), "stack", "1.2", {{"FILES", {".hay is\nfed"}}});
}

TEST(ManualPage, HasTheUsualHead) {
  const std::string page = sample_page();
  EXPECT_TRUE(page.starts_with(".TH STACK 1 \"\" \"Surfcast 1.2\" \"User Commands\"\n.SH NAME\nstack \\- Stacks hay\n"))
      << page;
}

TEST(ManualPage, SaysHowEachCommandIsUsed) {
  const std::string page = sample_page();
  EXPECT_THAT(page, HasSubstr(".SS make\n.PP\n\\fBstack make\\fR [\\fIOPTION\\fR ...] \\fIBALE\\fR ...\n"));
  EXPECT_THAT(page, HasSubstr("\\fBstack look\\fR \\fIARGUMENT\\fR ...\n"));
}

TEST(ManualPage, TellsEachFlagWithItsValueAndItsVariable) {
  const std::string page = sample_page();
  EXPECT_THAT(page, HasSubstr(".TP\n\\fB\\-\\-shape\\fR \\fIcone|cube\\fR\nWhich shape it's of.\n"));
  EXPECT_THAT(page, HasSubstr(".TP\n\\fB\\-\\-output\\fR \\fIFILE\\fR\nThe stack's file.\nMust be given.\n"
                              "Variable: \\fBSTACK_OUTPUT\\fR.\n"));
  EXPECT_THAT(page, HasSubstr(".TP\n\\fB\\-\\-dry\\fR\n"));
}

TEST(ManualPage, LeavesOutWhatIsHidden) {
  EXPECT_THAT(sample_page(), Not(HasSubstr("secret")));
}

TEST(ManualPage, NoLineOfTextBecomesARequest) {
  EXPECT_THAT(sample_page(), HasSubstr(".SH FILES\n.PP\n\\&.hay is\n.br\nfed\n"));
}

}  // namespace
}  // namespace surfcast::command_line
