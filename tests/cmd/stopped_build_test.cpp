// Builds that are stopped at every kind of moment: a library that the program is started with counts the calls that
// change files and stops the program before or after one of them. Between two such calls no file changes, so all that
// a stop can leave behind is seen, and the same on every run.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/run_program.h"
#include "cmd/wavy_scan.h"
#include "support/path_of.h"
#include "support/sample_size.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

/// Moments that are tried beside the last ones, at even distances, where a build has more of them.
const long kMoments = testing::sample_size("SURFCAST_STOPPED_BUILDS", 10);
/// So many at the end are all tried: there the model takes its place.
constexpr long kLastMoments = 16;

/// Waves over three rows of bricks, as NRRD.
void write_grid(const fs::path& path, int side) {
  std::ofstream grid(path, std::ios::binary);
  grid << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: " << side << ' ' << side << " 70\nencoding: raw\n\n";
  for (int i = 0; i < side * side * 70; ++i) grid.put(static_cast<char>(std::lround(99 + 90 * std::sin(0.01 * i))));
}

/// Gaussians on a wavy square, more than a block holds, as binary PLY.
void write_gaussians(const fs::path& path, int side) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << 4 * side * side;
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3"}) {
    file << "\nproperty float " << name;
  }
  file << "\nend_header\n";
  for (int i = 0; i < 4 * side * side; ++i) {
    const int row = i / side;
    const auto x = static_cast<float>(i % side), y = 0.25F * static_cast<float>(row);
    const float splat[] = {x, y, std::sin(x / 9), 0.1F, 0.2F, 0.3F, 1, -2, -2, -3, 1, 0, 0, 0};
    file.write(reinterpret_cast<const char*>(splat), sizeof(splat));
  }
}

/// The moments to try of so many. How many changes of files there are varies with the order of threads a little, which
/// the last moments cover.
std::set<long> moments_of(long count) {
  std::set<long> chosen;
  for (long i = 0; i < kMoments; ++i) chosen.insert(1 + i * (count - 1) / kMoments);
  for (long i = 0; i < kLastMoments; ++i) chosen.insert(std::max(1L, count - i));
  return chosen;
}

/// Runs a command with these variables in its environment; the exit code, or 128 and the signal.
int run_counted(std::vector<std::string> variables, std::vector<std::string> command) {
  std::vector<std::string> line{"/usr/bin/env", "LD_PRELOAD=" + path_of("stop_at_call")};
  std::ranges::move(variables, std::back_inserter(line));
  std::ranges::move(command, std::back_inserter(line));
  return client::wait_for_program(client::start_program(line));
}

std::vector<std::string> stop_at(long moment, int signal) {
  return {"SURFCAST_STOP_AT=" + std::to_string(moment), "SURFCAST_STOP_SIGNAL=" + std::to_string(signal)};
}

/// A program that builds what `write` writes, and how often it changes files at least.
struct Builder {
  std::string name;
  const char* source;  ///< file name
  void (*write)(const fs::path& path, int side);
  std::vector<std::string> (*command)(const std::string& scan, const std::string& target);
  long least_moments;

  friend std::ostream& operator<<(std::ostream& stream, const Builder& builder) { return stream << builder.name; }
};

const Builder kBuilders[] = {
    {"AsAWhole", "scan.ply", testing::write_waves,
     [](const std::string& scan, const std::string& target) {
       return std::vector<std::string>{path_of("surfcastd"), "build", scan, "--output", target};
     },
     10},
    {"InManyParts", "scan.ply", testing::write_waves,
     [](const std::string& scan, const std::string& target) {
       return std::vector<std::string>{path_of("build_in_parts"), scan, target, "1200"};
     },
     60},
    {"AVolume", "grid.nrrd", write_grid,
     [](const std::string& grid, const std::string& target) {
       return std::vector<std::string>{path_of("surfcastd"), "build", grid, "--output", target};
     },
     10},
    {"Gaussians", "gaussians.ply", write_gaussians,
     [](const std::string& gaussians, const std::string& target) {
       return std::vector<std::string>{path_of("surfcastd"), "build", gaussians, "--output", target};
     },
     10},
};

/// A folder with a source, and the model that an undisturbed build makes of it.
class StoppedBuildTest : public ::testing::TestWithParam<Builder> {
 protected:
  void SetUp() override {
    const fs::path name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(::testing::TempDir()) / ("stopped_build_" + name.filename().string() + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::signal(SIGINT, SIG_DFL);  // may be ignored, which programs inherit
    GetParam().write(source(), 100);
    const fs::path counted = folder_ / "moments";
    ASSERT_EQ(build({"SURFCAST_MOMENTS=" + counted.string()}), 0);
    moments_ = std::stol(testing::bytes_in(counted));
    ASSERT_GE(moments_, GetParam().least_moments);
    whole_ = testing::bytes_in(target());
    ASSERT_FALSE(whole_.empty());
    fs::remove(counted);
    fs::remove(target());
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path source() const { return folder_ / GetParam().source; }
  [[nodiscard]] fs::path target() const { return folder_ / "model.surf"; }

  [[nodiscard]] int build(std::vector<std::string> variables) const {
    return run_counted(std::move(variables), GetParam().command(source(), target()));
  }

  /// Returns whether the build was still going on at that moment.
  [[nodiscard]] bool stop_build(long moment, int signal) const {
    const int code = build(stop_at(moment, signal));
    EXPECT_TRUE(code == 128 + signal || code == 0) << code;
    return code == 128 + signal;
  }

  [[nodiscard]] std::set<long> moments() const { return moments_of(moments_); }

  /// What is in the folder beside the source and the model.
  [[nodiscard]] std::string leftovers() const {
    std::string names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (entry.path() != source() && entry.path() != target()) names += entry.path().filename().string() + ' ';
    }
    return names;
  }

  void remove_leftovers() const {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (entry.path() != source() && entry.path() != target()) fs::remove(entry.path());
    }
  }

  fs::path folder_;
  std::string whole_;
  long moments_ = 0;
};

INSTANTIATE_TEST_SUITE_P(Builders, StoppedBuildTest, ::testing::ValuesIn(kBuilders),
                         [](const auto& builder) { return builder.param.name; });

TEST_P(StoppedBuildTest, TheTargetIsAbsentOrWhole) {
  size_t stopped = 0;
  bool was_absent = false, was_whole = false;
  for (const long moment : moments()) {
    const int signal = moment % 3 == 0 ? SIGKILL : SIGINT;
    stopped += stop_build(moment, signal) ? 1 : 0;
    const bool exists = fs::exists(target());
    if (exists) {
      ASSERT_TRUE(testing::bytes_in(target()) == whole_) << "a model that is not whole, stopped at " << moment;
    }
    (exists ? was_whole : was_absent) = true;
    if (signal == SIGINT) {
      ASSERT_EQ(leftovers(), "") << "stopped at " << moment << " of " << moments_;
    }
    fs::remove(target());
    remove_leftovers();
  }
  EXPECT_GE(stopped, moments().size() * 9 / 10);
  EXPECT_TRUE(was_absent && was_whole) << "stops before and after the model was in its place";
}

TEST_P(StoppedBuildTest, AnOldModelStaysUntilTheNewOneIsWhole) {
  const std::string old = "an old model, of which nothing may get lost";
  bool was_old = false, was_whole = false;
  for (const long moment : moments()) {
    std::ofstream(target(), std::ios::binary) << old;
    const int signal = moment % 3 == 0 ? SIGINT : SIGKILL;
    static_cast<void>(stop_build(moment, signal));
    const std::string now = testing::bytes_in(target());
    ASSERT_TRUE(now == old || now == whole_) << now.size() << ", stopped at " << moment;
    (now == old ? was_old : was_whole) = true;
    if (signal == SIGINT) {
      ASSERT_EQ(leftovers(), "") << "stopped at " << moment << " of " << moments_;
    }
    remove_leftovers();
  }
  EXPECT_TRUE(was_old && was_whole) << "stops before and after the model was in its place";
}

/// Scans that are added to a model.
class StoppedAppendTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("stopped_append_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::signal(SIGINT, SIG_DFL);  // may be ignored, which programs inherit
    testing::write_waves(folder_ / "west.ply", 150);
    testing::write_waves_from(folder_ / "east.ply", 100, 150);
    ASSERT_EQ(run_counted({}, {path_of("surfcastd"), "build", folder_ / "west.ply", "--output", model_}), 0);
    before_ = testing::bytes_in(model_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] int append(std::vector<std::string> variables) const {
    return run_counted(std::move(variables), {path_of("surfcastd"), "build", folder_ / "east.ply", "--into", model_});
  }
  [[nodiscard]] size_t files() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
  fs::path model_ = fs::path(::testing::TempDir()) / ("stopped_append_" + std::to_string(getpid())) / "model.surf";
  std::string before_;
};

TEST_F(StoppedAppendTest, TheModelIsTheFormerOneUntilTheGrownOneIsWhole) {
  const fs::path counted = folder_ / "moments";
  ASSERT_EQ(append({"SURFCAST_MOMENTS=" + counted.string()}), 0);
  const std::string grown = testing::bytes_in(model_);
  const long count = std::stol(testing::bytes_in(counted));
  fs::remove(counted);
  ASSERT_TRUE(grown != before_);
  bool was_former = false, was_grown = false;
  for (const long moment : moments_of(count)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (entry.path().extension() != ".ply") fs::remove(entry.path());
    }
    std::ofstream(model_, std::ios::binary) << before_;
    const int signal = moment % 3 == 0 ? SIGINT : SIGKILL;
    const int code = append(stop_at(moment, signal));
    ASSERT_TRUE(code == 128 + signal || code == 0) << code;
    const std::string now = testing::bytes_in(model_);
    ASSERT_TRUE(now == before_ || now == grown) << now.size() << ", stopped at " << moment;
    (now == grown ? was_grown : was_former) = true;
    if (signal == SIGINT) {
      ASSERT_EQ(files(), 3U) << "stopped at " << moment << " of " << count;
    }
  }
  EXPECT_TRUE(was_former && was_grown) << "stops before and after the model was in its place";
}

}  // namespace
}  // namespace surfcast::cmd
