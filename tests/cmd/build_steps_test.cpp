// The steps of a build in parts as programs: killed in the middle of what they write, and called by schedulers.

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "client/run_program.h"
#include "cmd/wavy_scan.h"
#include "support/path_of.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

using testing::bytes_in;
using testing::write_waves;

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

int run(const Words& words) {
  return client::wait_for_program(client::start_program(words));
}

class BuildStepProgramsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(::testing::TempDir()) / ("build_steps_" + std::string(name) + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write_waves(scan_ = folder_ / "scan.ply", 100);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] Words step(const Words& words) const {
    return Words{path_of("surfcastd")} + words + Words{"--work", work()};
  }
  [[nodiscard]] std::string work() const { return (folder_ / "work").string(); }
  [[nodiscard]] std::string model() const { return (folder_ / "model.surf").string(); }

  /// The bytes of the model that one process builds in so many parts.
  [[nodiscard]] std::string built_at_once(int parts) const {
    const fs::path target = folder_ / "at_once.surf";
    EXPECT_EQ(run({path_of("surfcastd"), "build", scan_.string(), "--parts", std::to_string(parts), "--output",
                   target.string()}),
              0);
    return bytes_in(target);
  }

  /// Kills a step at a moment of its writing, which it reaches, and then runs it again to its end.
  void kill_and_repeat(const Words& words, int moment) const {
    const Words stopped =
        Words{"/usr/bin/env", "LD_PRELOAD=" + path_of("stop_at_call"), "SURFCAST_STOP_AT=" + std::to_string(moment),
              "SURFCAST_STOP_SIGNAL=" + std::to_string(SIGKILL)} +
        step(words);
    EXPECT_EQ(run(stopped), 128 + SIGKILL) << words[0] << " at " << moment;
    EXPECT_EQ(run(step(words)), 0) << words[0] << " after " << moment;
  }

  [[nodiscard]] Words call_of_make(const std::string& program) const {
    return {"/usr/bin/env",
            "make",
            "-s",
            "-f",
            path_of("deploy/build-in-parts") + "/Makefile",
            "-j2",
            "SURFCASTD=" + program,
            "SCANS=" + scan_.string(),
            "PARTS=4",
            "WORK=" + work(),
            "MODEL=" + model()};
  }

  /// Whether files of parts are left, which are deleted once their blocks are there.
  [[nodiscard]] bool has_parts() const {
    const fs::directory_iterator files(work());
    return std::any_of(begin(files), end(files),
                       [](const auto& file) { return file.path().filename().string().starts_with("part-"); });
  }

  fs::path folder_;
  fs::path scan_;
};

class KilledStepsTest : public BuildStepProgramsTest, public ::testing::WithParamInterface<int> {};

INSTANTIATE_TEST_SUITE_P(Parts, KilledStepsTest, ::testing::Values(1, 4, 16),
                         [](const auto& parts) { return "Of" + std::to_string(parts.param); });

TEST_P(KilledStepsTest, GiveTheBytesOfOneBuildInAnyOrder) {
  const int parts = GetParam();
  std::mt19937 random(static_cast<unsigned>(parts));
  std::vector<int> order(static_cast<size_t>(parts));
  std::iota(order.begin(), order.end(), 1);
  // Every step opens its file, writes to it several times, flushes and renames it: eight moments at least.
  const auto moment = [&random] { return 1 + static_cast<int>(random() % 8); };
  kill_and_repeat({"build-plan", scan_.string(), "--parts", std::to_string(parts)}, moment());
  std::shuffle(order.begin(), order.end(), random);
  for (const int part : order) kill_and_repeat({"build-part", std::to_string(part)}, moment());
  kill_and_repeat({"build-signs"}, moment());
  std::shuffle(order.begin(), order.end(), random);
  for (const int part : order) kill_and_repeat({"build-blocks", std::to_string(part)}, moment());
  kill_and_repeat({"build-merge", "--output", model()}, moment());
  EXPECT_TRUE(bytes_in(model()) == built_at_once(parts));
}

TEST_F(BuildStepProgramsTest, MissingPartsAreOneLineAndAFailure) {
  ASSERT_EQ(run(step({"build-plan", scan_.string(), "--parts", "4"})), 0);
  ASSERT_EQ(run(step({"build-part", "3"})), 0);
  const fs::path said = folder_ / "said";
  const std::string line =
      path_of("surfcastd") + " build-merge --work " + work() + " --output " + model() + " 2> " + said.string();
  EXPECT_EQ(run({"/bin/sh", "-c", line}), 1);
  const std::string text = bytes_in(said);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_NE(text.find("of the 4 files blocks-K, missing: 1-4"), std::string::npos) << text;
  EXPECT_FALSE(fs::exists(model()));
}

TEST_F(BuildStepProgramsTest, MakeRunsTheSteps) {
  const Words make = call_of_make(path_of("surfcastd"));
  ASSERT_EQ(run(make), 0);
  EXPECT_TRUE(bytes_in(model()) == built_at_once(4));
  EXPECT_FALSE(has_parts());
  const fs::file_time_type before = fs::last_write_time(model());
  ASSERT_EQ(run(make), 0);
  EXPECT_EQ(fs::last_write_time(model()), before) << "all is done";
  // Of a run that was stopped before the last blocks, only what is missing is made.
  const fs::file_time_type blocks = fs::last_write_time(work() + "/blocks-1");
  fs::remove(work() + "/blocks-3");
  fs::remove(model());
  ASSERT_EQ(run(make), 0);
  EXPECT_EQ(fs::last_write_time(work() + "/blocks-1"), blocks);
  EXPECT_TRUE(bytes_in(model()) == built_at_once(4));
}

TEST_F(BuildStepProgramsTest, ARunOfMakeThatFailsKeepsItsParts) {
  const fs::path failing = folder_ / "failing";  // in the step of the signs
  std::ofstream(failing) << "#!/bin/sh\n[ $1 != build-signs ] && exec " + path_of("surfcastd") + " \"$@\"\n";
  fs::permissions(failing, fs::perms::owner_all);
  EXPECT_NE(run(call_of_make(failing.string())), 0);
  for (int part = 1; part <= 4; ++part) EXPECT_TRUE(fs::exists(work() + "/part-" + std::to_string(part))) << part;
  EXPECT_EQ(run(call_of_make(path_of("surfcastd"))), 0);
  EXPECT_TRUE(bytes_in(model()) == built_at_once(4));
}

TEST_F(BuildStepProgramsTest, SnakemakeRunsTheSteps) {
  if (run({"/bin/sh", "-c", "command -v snakemake > /dev/null"}) != 0) GTEST_SKIP() << "no snakemake here";
  const std::string line = "cd " + folder_.string() + " && snakemake -q --cores 2 -s " +
                           path_of("deploy/build-in-parts") + "/Snakefile --config surfcastd=" + path_of("surfcastd") +
                           " scans=" + scan_.string() + " parts=4 work=" + work() + " model=" + model();
  ASSERT_EQ(run({"/bin/sh", "-c", line}), 0);
  EXPECT_TRUE(bytes_in(model()) == built_at_once(4));
  EXPECT_FALSE(has_parts());
}

TEST_F(BuildStepProgramsTest, TheScriptOfSlurmSubmitsTheSteps) {
  // An sbatch that runs the tasks of a job at once, arrays from the last task to the first. Numbers of jobs count up,
  // and a job must wait for the one before.
  const fs::path sbatch = folder_ / "sbatch";
  std::ofstream(sbatch) << "#!/bin/sh\nset -eu\n"
                           "job=$(($(cat \"$JOBS\") + 1)); tasks=0; after=0\n"
                           "while [ $# -gt 0 ]; do case $1 in\n"
                           "--array=1-*) tasks=${1#--array=1-};;\n"
                           "--dependency=afterok:*) after=${1#--dependency=afterok:};;\n"
                           "--wrap) shift; command=$1;;\n"
                           "esac; shift; done\n"
                           "[ $after -eq $((job - 1)) ]\n"
                           "for task in $(seq $tasks -1 1) $([ $tasks -gt 0 ] || echo none); do\n"
                           "SLURM_ARRAY_TASK_ID=$task sh -c \"$command\" >&2; done\n"
                           "echo $job > \"$JOBS\"; echo $job\n";
  fs::permissions(sbatch, fs::perms::owner_all);
  std::ofstream(folder_ / "jobs") << "0\n";
  const Words line{"/usr/bin/env",
                   "PATH=" + folder_.string() + ":" + std::getenv("PATH"),
                   "JOBS=" + (folder_ / "jobs").string(),
                   "SURFCASTD=" + path_of("surfcastd"),
                   "PARTS=4",
                   path_of("deploy/build-in-parts") + "/slurm.sh",
                   model(),
                   work(),
                   scan_.string()};
  ASSERT_EQ(run(line), 0);
  EXPECT_EQ(bytes_in(folder_ / "jobs"), "5\n");
  EXPECT_TRUE(bytes_in(model()) == built_at_once(4));
  EXPECT_FALSE(has_parts());
}

}  // namespace
}  // namespace surfcast::cmd
