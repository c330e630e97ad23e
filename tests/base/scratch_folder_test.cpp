#include "base/scratch_folder.h"

#include <csignal>
#include <filesystem>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/atomic_file.h"

namespace surfcast {
namespace {

namespace fs = std::filesystem;

class ScratchFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    parent_ = fs::path(::testing::TempDir()) /
              ("scratch_folder_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(parent_);
    fs::create_directories(parent_);
  }
  void TearDown() override { fs::remove_all(parent_); }
  [[nodiscard]] auto entries() const {
    return std::distance(fs::directory_iterator(parent_), fs::directory_iterator());
  }

  fs::path parent_;
};

TEST_F(ScratchFolderTest, EachIsOnItsOwnAndGoesWithItsContent) {
  {
    Result<ScratchFolder> first = ScratchFolder::create(parent_, "part-");
    const Result<ScratchFolder> second = ScratchFolder::create(parent_, "part-");
    ASSERT_TRUE(first && second);
    EXPECT_NE(first->path(), second->path());
    const ScratchFolder moved = std::move(*first);
    EXPECT_TRUE(write_file_atomically(moved.path() / "file", "text"));
    EXPECT_EQ(entries(), 2);
  }
  EXPECT_EQ(entries(), 0);
}

TEST_F(ScratchFolderTest, WhatAKilledProcessLeavesIsRemovedAndFoldersInUseStay) {
  const auto killed = [this] {
    const Result<ScratchFolder> folder = ScratchFolder::create(parent_, "part-");
    EXPECT_TRUE(write_file_atomically(folder->path() / "file", "text"));
    std::raise(SIGKILL);
  };
  EXPECT_EXIT(killed(), ::testing::KilledBySignal(SIGKILL), "");
  fs::create_directory(parent_ / "other");
  const Result<ScratchFolder> used = ScratchFolder::create(parent_, "part-");
  EXPECT_EQ(entries(), 3);
  remove_abandoned_folders(parent_, "part-");
  EXPECT_EQ(entries(), 2);
  EXPECT_TRUE(fs::exists(used->path()));
}

TEST_F(ScratchFolderTest, AMissingParentIsAnErrorThatNamesIt) {
  const Result<ScratchFolder> folder = ScratchFolder::create(parent_ / "absent", "part-");
  ASSERT_FALSE(folder);
  EXPECT_NE(folder.error().message.find("absent"), std::string::npos);
}

}  // namespace
}  // namespace surfcast
