#include "base/child_process.h"

#include <atomic>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast {
namespace {

using ::testing::ElementsAre;

struct Ended {
  Result<int> outcome;
  std::vector<std::string> lines;
};

Ended run(const std::string& script, std::atomic<bool>& cancelled, const std::string& cancel_at = "-") {
  Ended done;
  done.outcome = run_child(
      {"/bin/sh", "-c", script},
      [&](std::string_view line) {
        done.lines.emplace_back(line);
        if (line == cancel_at) cancelled = true;
      },
      Preemption(cancelled));
  return done;
}

TEST(ChildProcessTest, ItsLinesAndItsCodeArriveFromBothOutputs) {
  std::atomic<bool> never{false};
  const Ended done = run("echo one; echo two >&2; printf three; exit 7", never);
  ASSERT_TRUE(done.outcome);
  EXPECT_EQ(*done.outcome, 7);
  EXPECT_THAT(done.lines, ElementsAre("one", "two", "three"));
}

TEST(ChildProcessTest, ItIsToldToEndWhenItIsCancelled) {
  std::atomic<bool> cancelled{false};
  const Ended done = run("trap 'echo told; exit 0' TERM; echo begun; while :; do sleep 0.01; done", cancelled, "begun");
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().kind, ErrorKind::kCancelled);
  EXPECT_THAT(done.lines, ElementsAre("begun", "told"));
}

TEST(ChildProcessTest, TheSignalThatEndsItIsItsCode) {
  std::atomic<bool> never{false};
  EXPECT_EQ(*run("kill -9 $$", never).outcome, 128 + 9);
}

TEST(ChildProcessTest, AProgramThatIsNotThereIsAnError) {
  const std::atomic<bool> never{false};
  const Result<int> outcome = run_child(
      {"/nowhere/program"}, [](std::string_view) {}, Preemption(never));
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().message.find("/nowhere/program"), std::string::npos);
}

}  // namespace
}  // namespace surfcast
