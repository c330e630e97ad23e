// The sandbox, in child processes: each tries what it must not be able to do.

#include "worker/sandbox.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace surfcast::worker {
namespace {

constexpr int kUnsupported = 77;

/// The exit code of a child process that runs `inside`.
int in_child(const std::function<int()>& inside) {
  const pid_t child = ::fork();
  if (child == 0) std::_Exit(inside());
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  return WEXITSTATUS(status);
}

class SandboxTest : public ::testing::Test {
 protected:
  // A folder of its own for each test: they run as processes side by side.
  SandboxTest()
      : folder_(std::filesystem::path(::testing::TempDir()) /
                (std::string("sandbox_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
                 std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "file") << "content";
  }
  ~SandboxTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file() const { return (folder_ / "file").string(); }

  /// Expects that this fails with the error after files are restricted to `readable`.
  void expect_files(const std::vector<std::string>& readable, const std::function<bool()>& fails) {
    const int code = in_child([&] {
      const Status restricted = restrict_files({readable});
      if (!restricted) return restricted.error().kind == ErrorKind::kUnsupported ? kUnsupported : 2;
      return fails() ? 0 : 1;
    });
    if (code == kUnsupported) GTEST_SKIP() << "the kernel has no Landlock";
    EXPECT_EQ(code, 0);
  }
  void expect_calls(const std::function<bool()>& fails) {
    const int code = in_child([&] {
      const Status restricted = restrict_calls();
      if (!restricted) return restricted.error().kind == ErrorKind::kUnsupported ? kUnsupported : 2;
      return fails() ? 0 : 1;
    });
    if (code == kUnsupported) GTEST_SKIP() << "the kernel has no filters of system calls";
    EXPECT_EQ(code, 0);
  }

  std::filesystem::path folder_;
};

TEST_F(SandboxTest, OtherFilesCannotBeRead) {
  expect_files({"/usr"}, [&] { return ::open(file().c_str(), O_RDONLY) < 0 && errno == EACCES; });
}

TEST_F(SandboxTest, ReadableFilesCanBeReadAndNotWritten) {
  expect_files({folder_.string()}, [&] {
    return ::open(file().c_str(), O_RDONLY) >= 0 && ::open(file().c_str(), O_WRONLY) < 0 && errno == EACCES;
  });
}

TEST_F(SandboxTest, NothingIsCreatedOrRemoved) {
  expect_files({folder_.string()}, [&] {
    return ::open((file() + "2").c_str(), O_WRONLY | O_CREAT, 0600) < 0 && errno == EACCES &&
           ::unlink(file().c_str()) < 0 && errno == EACCES;
  });
  EXPECT_TRUE(std::filesystem::exists(file()));
}

TEST_F(SandboxTest, WritableFoldersCanBeChangedAndNothingBesideThem) {
  std::filesystem::create_directories(folder_ / "cache");
  const int code = in_child([&] {
    const Status restricted = restrict_files({{folder_.string()}, {(folder_ / "cache").string()}});
    if (!restricted) return kUnsupported;
    const std::string name = (folder_ / "cache" / "new").string();
    const bool inside = ::open(name.c_str(), O_WRONLY | O_CREAT, 0600) >= 0 &&
                        ::rename(name.c_str(), (name + "er").c_str()) == 0 && ::unlink((name + "er").c_str()) == 0;
    return inside && ::open((folder_ / "new").c_str(), O_WRONLY | O_CREAT, 0600) < 0 ? 0 : 1;
  });
  if (code == kUnsupported) GTEST_SKIP() << "the kernel has no Landlock";
  EXPECT_EQ(code, 0);
}

TEST_F(SandboxTest, DevicesCanBeOpenedUnlessTheyAreForbidden) {
  expect_files({"/usr"}, [] { return ::open("/dev/null", O_RDWR) >= 0; });
  const int code = in_child([] {
    if (!restrict_files({{"/usr"}, {}, /*devices=*/false})) return kUnsupported;
    return ::open("/dev/null", O_RDONLY) < 0 ? 0 : 1;
  });
  EXPECT_TRUE(code == 0 || code == kUnsupported) << code;
}

TEST_F(SandboxTest, OpenDescriptorsStayUsable) {
  const int opened = ::open(file().c_str(), O_RDONLY);
  ASSERT_GE(opened, 0);
  expect_files({"/usr"}, [&] {
    char first = 0;
    return ::pread(opened, &first, 1, 0) == 1 && first == 'c';
  });
  ::close(opened);
}

TEST_F(SandboxTest, ThreadsThatAreStartedLaterAreRestricted) {
  expect_files({"/usr"}, [&] {
    bool denied = false;
    std::thread([&] { denied = ::open(file().c_str(), O_RDONLY) < 0; }).join();
    return denied;
  });
}

TEST_F(SandboxTest, NoNetwork) {
  expect_calls([] { return ::socket(AF_INET, SOCK_STREAM, 0) < 0 && errno == EPERM; });
  expect_calls([] { return ::socket(AF_UNIX, SOCK_STREAM, 0) < 0 && errno == EPERM; });
}

TEST_F(SandboxTest, NoProcessesAndNoPrograms) {
  expect_calls([] { return ::fork() < 0; });
  expect_calls([] { return ::execl("/bin/true", "true", nullptr) < 0 && errno == EPERM; });
}

TEST_F(SandboxTest, NoSignalsToOthers) {
  expect_calls([] { return ::kill(::getppid(), 0) < 0 && errno == EPERM; });
}

TEST_F(SandboxTest, ThreadsCanBeStartedAndAbortWorks) {
  expect_calls([] {
    bool ran = false;
    std::thread([&] { ran = true; }).join();
    return ran && std::raise(0) == 0;
  });
}

TEST_F(SandboxTest, ThreadsThatRunAlreadyAreRestricted) {
  expect_calls([] { return true; });  // skips where there are no filters
  const int code = in_child([] {
    std::atomic<bool> restricted = false;
    std::atomic<int> result = 1;
    std::thread early([&] {
      while (!restricted) std::this_thread::yield();
      result = ::socket(AF_INET, SOCK_STREAM, 0) < 0 ? 0 : 3;
    });
    const bool done = restrict_calls().has_value();
    restricted = true;
    early.join();
    return done ? result.load() : kUnsupported;
  });
  EXPECT_TRUE(code == 0 || code == kUnsupported) << code;
}

}  // namespace
}  // namespace surfcast::worker
