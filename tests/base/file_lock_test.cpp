#include "base/file_lock.h"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace surfcast {
namespace {

namespace fs = std::filesystem;

class FileLockTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("lock_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    file_ = folder_ / "file";
    std::ofstream(file_) << "content";
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
  fs::path file_;
};

TEST_F(FileLockTest, SharedLocksKeepOutTheOneThatWouldBeAlone) {
  {
    const std::optional<FileLock> first = FileLock::share(file_);
    const std::optional<FileLock> second = FileLock::share(file_);
    EXPECT_TRUE(first && second);
    EXPECT_FALSE(FileLock::try_alone(file_));
  }
  const std::optional<FileLock> alone = FileLock::try_alone(file_);
  EXPECT_TRUE(alone);
  EXPECT_FALSE(FileLock::try_alone(file_));
}

TEST_F(FileLockTest, ALockIsOfTheFileAndNotOfItsName) {
  const std::optional<FileLock> old = FileLock::share(file_);
  std::ofstream(folder_ / "new") << "other content";
  fs::rename(folder_ / "new", file_);
  EXPECT_TRUE(FileLock::try_alone(file_));
}

TEST_F(FileLockTest, WhatIsNotThereIsNotLocked) {
  EXPECT_FALSE(FileLock::share(folder_ / "absent"));
  EXPECT_FALSE(FileLock::try_alone(folder_ / "absent"));
  fs::create_symlink(file_, folder_ / "link");
  EXPECT_FALSE(FileLock::share(folder_ / "link")) << "the name of a link is not that of a file";
}

}  // namespace
}  // namespace surfcast
