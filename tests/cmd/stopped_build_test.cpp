#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "base/stopwatch.h"
#include "client/run_program.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

/// Builds that each test stops.
constexpr int kRounds = 15;

std::string content(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A wavy square of points, as binary PLY.
void write_scan(const fs::path& path, int side) {
  std::ofstream scan(path, std::ios::binary);
  scan << "ply\nformat binary_little_endian 1.0\nelement vertex " << side * side
       << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (int i = 0; i < side * side; ++i) {
    const int row = i / side;
    const auto x = static_cast<float>(i % side), y = static_cast<float>(row);
    const float point[] = {x, y, std::sin(x / 9) * std::cos(y / 7)};
    scan.write(reinterpret_cast<const char*>(point), sizeof(point));
  }
}

/// A folder with a scan, and the model that an undisturbed build makes of it.
class StoppedBuildTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("stopped_build_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::signal(SIGINT, SIG_DFL);  // may be ignored, which programs inherit
    write_scan(folder_ / "scan.ply", 150);
    const Stopwatch stopwatch;
    ASSERT_EQ(client::wait_for_program(start_build()), 0);
    seconds_ = stopwatch.seconds();
    whole_ = content(target());
    fs::remove(target());
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path target() const { return folder_ / "model.surf"; }
  [[nodiscard]] pid_t start_build() const {
    return client::start_program({SURFCASTD, "build", folder_ / "scan.ply", "--output", target()});
  }

  /// Sends the signal at a random moment of the build. Returns whether the build was still going on.
  bool stop_a_build(int signal) {
    const pid_t build = start_build();
    const double moment = std::uniform_real_distribution<>(0, 1.1 * seconds_)(random_);
    std::this_thread::sleep_for(std::chrono::duration<double>(moment));
    ::kill(build, signal);
    return client::wait_for_program(build) == 128 + signal;
  }

  /// What is in the folder beside the scan and the model.
  [[nodiscard]] std::string leftovers() const {
    std::string names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename();
      if (name != "scan.ply" && name != "model.surf") names += name + ' ';
    }
    return names;
  }

  void remove_leftovers() const {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (entry.path().filename() != "scan.ply" && entry.path() != target()) fs::remove(entry.path());
    }
  }

  fs::path folder_;
  std::string whole_;
  double seconds_ = 0;
  std::mt19937 random_{std::random_device{}()};
};

TEST_F(StoppedBuildTest, TheTargetIsAbsentOrWhole) {
  int stopped = 0;
  for (int i = 0; i < kRounds; ++i) {
    const int signal = i % 2 == 0 ? SIGKILL : SIGINT;
    stopped += stop_a_build(signal);
    if (fs::exists(target())) {
      ASSERT_TRUE(content(target()) == whole_) << "a model that is not whole";
    }
    if (signal == SIGINT) {
      ASSERT_EQ(leftovers(), "");
    }
    fs::remove(target());
    remove_leftovers();
  }
  EXPECT_GT(stopped, 0);
  RecordProperty("stopped", stopped);
}

TEST_F(StoppedBuildTest, AnOldModelStaysUntilTheNewOneIsWhole) {
  const std::string old = "an old model, of which nothing may get lost";
  int stopped = 0;
  for (int i = 0; i < kRounds; ++i) {
    std::ofstream(target(), std::ios::binary) << old;
    const int signal = i % 2 == 0 ? SIGKILL : SIGINT;
    stopped += stop_a_build(signal);
    const std::string now = content(target());
    ASSERT_TRUE(now == old || now == whole_) << now.size();
    if (signal == SIGINT) {
      ASSERT_EQ(leftovers(), "");
    }
    remove_leftovers();
  }
  EXPECT_GT(stopped, 0);
  RecordProperty("stopped", stopped);
}

}  // namespace
}  // namespace surfcast::cmd
