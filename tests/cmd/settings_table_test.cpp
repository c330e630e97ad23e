#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/run_program.h"
#include "support/path_of.h"

namespace surfcast::cmd {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

struct Flag {
  std::string name;
  std::string type;
  std::string variable;
};

/// The flags of a command, as its help lists them.
std::vector<Flag> flags_of(const std::string& command) {
  const client::ProgramOutcome help = client::run_program(path_of("surfcastd") + " " + command + " --help");
  EXPECT_EQ(help.code, 0);
  const std::regex form("\n  (?:-h,)?--([a-z0-9-]+)(?:,--[a-z-]+)?(?: ([A-Z]+))?(?:[^\n]*\\(Env:([A-Z0-9_]+)\\))?");
  std::vector<Flag> flags;
  for (std::sregex_iterator found(help.output.begin(), help.output.end(), form), end; found != end; ++found) {
    flags.push_back({(*found)[1], (*found)[2], (*found)[3]});
  }
  return flags;
}

std::string variable_of(const std::string& flag) {
  std::string name = "SURFCAST_";
  for (const char c : flag) name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

bool is_setting(const Flag& flag) {
  return flag.type == "SIZE" || flag.type == "NUMBER" || flag.type == "SECONDS";
}

/// Names of flags in the first column of the tables of docs/settings.md.
std::set<std::string> documented_flags() {
  std::ifstream stream(path_of("docs/settings.md"));
  std::set<std::string> flags;
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with("| `--")) continue;
    const std::string flag = line.substr(5, line.find('`', 5) - 5);
    EXPECT_THAT(line, HasSubstr("| `" + variable_of(flag) + "` |"));
    EXPECT_EQ(std::count(line.begin(), line.end(), '|'), 7) << line;
    flags.insert(flag);
  }
  return flags;
}

TEST(SettingsTableTest, ListsEveryLimitOfTheServerAndNoOther) {
  std::set<std::string> settings;
  for (const Flag& flag : flags_of("serve")) {
    if (is_setting(flag)) settings.insert(flag.name);
  }
  EXPECT_GT(settings.size(), 30U);
  EXPECT_EQ(documented_flags(), settings);
}

TEST(SettingsTableTest, EveryFlagOfTheServerHasItsVariable) {
  for (const Flag& flag : flags_of("serve")) {
    if (flag.name == "help") continue;
    EXPECT_EQ(flag.variable, variable_of(flag.name));
  }
}

TEST(SettingsTableTest, RenderAndPickShareSettingsWithTheServer) {
  const auto names = [](const std::string& command) {
    std::vector<std::string> all;
    for (const Flag& flag : flags_of(command)) all.push_back(flag.name);
    return all;
  };
  for (const std::string flag : {"gpu-memory", "host-memory", "decoders", "max-pixels", "max-side", "cache-size"}) {
    EXPECT_THAT(names("render"), Contains(flag));
  }
  for (const std::string flag : {"pick-cache", "cache-size", "build-memory"}) {
    EXPECT_THAT(names("pick"), Contains(flag));
  }
}

TEST(SettingsTableTest, AWrongValueIsOneLineThatNamesTheFlag) {
  for (const Flag& flag : flags_of("serve")) {
    if (!is_setting(flag)) continue;
    const client::ProgramOutcome outcome =
        client::run_program(path_of("surfcastd") + " serve --" + flag.name + " wrong 2>&1");
    EXPECT_EQ(outcome.code, 2) << flag.name;
    EXPECT_THAT(outcome.output, StartsWith("surfcastd: --" + flag.name + ": "));
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
  }
}

/// One setting of each type stands for all: what names the variable is the same for every flag.
TEST(SettingsTableTest, AWrongValueOfAVariableIsOneLineThatNamesTheVariable) {
  for (const std::string variable : {"SURFCAST_GPU_MEMORY", "SURFCAST_MAX_PIXELS", "SURFCAST_IDLE_TIMEOUT"}) {
    const client::ProgramOutcome outcome =
        client::run_program(variable + "=wrong " + path_of("surfcastd") + " serve 2>&1");
    EXPECT_EQ(outcome.code, 2) << variable;
    EXPECT_THAT(outcome.output, StartsWith("surfcastd: " + variable + ": "));
    EXPECT_THAT(outcome.output, Not(HasSubstr("--"))) << "nobody gave a flag";
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
  }
}

TEST(SettingsTableTest, TheCommandLineWinsAndIsThenWhatIsNamed) {
  const std::string wrong_flag = "SURFCAST_GPU_MEMORY=1G " + path_of("surfcastd") + " serve --gpu-memory=wrong 2>&1";
  EXPECT_THAT(client::run_program(wrong_flag).output, StartsWith("surfcastd: --gpu-memory: "));
  const std::string other =
      "SURFCAST_GPU_MEMORY=wrong " + path_of("surfcastd") + " serve --gpu-memory 1G --encoders 0 2>&1";
  EXPECT_THAT(client::run_program(other).output, StartsWith("surfcastd: --encoders: "));
  const std::string typed = "SURFCAST_GPU=first " + path_of("surfcastd") + " serve 2>&1";
  EXPECT_THAT(client::run_program(typed).output, HasSubstr("SURFCAST_GPU"));
  EXPECT_EQ(client::run_program(typed).code, 2);
}

}  // namespace
}  // namespace surfcast::cmd
