#include "command_line/shell_completion.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "client/run_program.h"
#include "command_line/sample_program.h"

namespace surfcast::command_line {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string sample_script(Shell shell) {
  const auto program = sample_program();
  return shell_completion(summarize_command(*program), "stack", shell);
}

/// What bash offers for the last of these words, in a line.
std::string offered(const std::string& words) {
  const std::string script = ::testing::TempDir() + "stack_completion." + std::to_string(::getpid()) + ".bash";
  std::ofstream(script) << sample_script(Shell::kBash) << "COMP_WORDS=(" << words << ")\n"
                        << "COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_stack\necho \"${COMPREPLY[@]}\"\n";
  const client::ProgramOutcome outcome = client::run_program("bash " + script + " 2>&1");
  std::filesystem::remove(script);
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  return outcome.output;
}

TEST(ShellCompletion, BashOffersCommandsFirst) {
  EXPECT_EQ(offered("stack ''"), "look make -h --help\n");
  EXPECT_EQ(offered("stack ma"), "make\n");
}

TEST(ShellCompletion, BashOffersTheFlagsOfACommand) {
  EXPECT_EQ(offered("stack make -"), "-h --help --shape --output --dry\n");
  EXPECT_EQ(offered("stack make --dry --s"), "--shape\n");
}

TEST(ShellCompletion, BashOffersTheValuesOfAFlag) {
  EXPECT_EQ(offered("stack make --shape ''"), "cone cube\n");
  EXPECT_EQ(offered("stack make --shape cu"), "cube\n");
}

TEST(ShellCompletion, BashLeavesOtherValuesToFileNames) {
  EXPECT_EQ(offered("stack make --output ''"), "\n");
  EXPECT_EQ(offered("stack make ''"), "\n");
}

TEST(ShellCompletion, ZshAndFishKnowTheSame) {
  const std::string zsh = sample_script(Shell::kZsh);
  EXPECT_THAT(zsh, HasSubstr("'make:Make a stack'"));
  EXPECT_THAT(zsh, HasSubstr("'--dry[Hay that is dry \\[and warm\\]]'"));
  EXPECT_THAT(zsh, HasSubstr("'--shape[Which shape it'\\''s of]:cone|cube:(cone cube)'"));
  const std::string fish = sample_script(Shell::kFish);
  EXPECT_THAT(fish, HasSubstr("-f -a make -d 'Make a stack'"));
  EXPECT_THAT(fish, HasSubstr("__fish_seen_subcommand_from make' -l shape -r -f -a 'cone cube' -d "));
}

TEST(ShellCompletion, NoShellOffersWhatIsHidden) {
  for (const Shell shell : {Shell::kBash, Shell::kZsh, Shell::kFish}) {
    EXPECT_THAT(sample_script(shell), Not(HasSubstr("secret")));
  }
}

TEST(ShellCompletion, ShellsAreKnownByName) {
  EXPECT_EQ(parse_shell("zsh"), Shell::kZsh);
  EXPECT_EQ(parse_shell("ksh"), std::nullopt);
}

}  // namespace
}  // namespace surfcast::command_line
