#include "base/atomic_file.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

namespace surfcast {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("atomic_file_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string content(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  [[nodiscard]] size_t entries() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(AtomicFileTest, CommitReplacesTheOldFile) {
  const fs::path target = folder_ / "out";
  ASSERT_TRUE(write_file_atomically(target, "old"));
  ASSERT_TRUE(write_file_atomically(target, "new"));
  EXPECT_EQ(content(target), "new");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, WithoutCommitTheOldFileStaysAndNothingElse) {
  const fs::path target = folder_ / "out";
  ASSERT_TRUE(write_file_atomically(target, "old"));
  {
    Result<AtomicFile> file = AtomicFile::create(target);
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->append(std::as_bytes(std::span("half", 4))));
  }
  EXPECT_EQ(content(target), "old");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, ASignalThatEndsTheProcessLeavesNothingButTheOldFile) {
  const fs::path target = folder_ / "out";
  ASSERT_TRUE(write_file_atomically(target, "old"));
  const auto interrupted = [&target](int signal) {
    std::signal(signal, SIG_DFL);  // a shell lets commands in the background ignore SIGINT
    remove_unfinished_files_on_signals();
    Result<AtomicFile> moved = AtomicFile::create(target);
    const AtomicFile file = std::move(*moved);
    std::raise(signal);
  };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(interrupted(signal), ::testing::KilledBySignal(signal), "");
    EXPECT_EQ(content(target), "old");
    EXPECT_EQ(entries(), 1u);
  }
}

TEST_F(AtomicFileTest, ManyFilesMayBeWrittenAtOnce) {
  std::vector<AtomicFile> files;
  for (int i = 0; i < 40; ++i) files.push_back(std::move(*AtomicFile::create(folder_ / "out")));
  EXPECT_EQ(entries(), 40u);
  for (AtomicFile& file : files) ASSERT_TRUE(file.commit());
  EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, HeaderIsOverwrittenInPlace) {
  const fs::path target = folder_ / "out";
  Result<AtomicFile> file = AtomicFile::create(target);
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append(std::as_bytes(std::span("....body", 8))));
  ASSERT_TRUE(file->overwrite(0, std::as_bytes(std::span("head", 4))));
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(content(target), "headbody");
}

TEST_F(AtomicFileTest, ANewFileReplacesNone) {
  const fs::path target = folder_ / "out";
  Result<AtomicFile> first = AtomicFile::create(target);
  ASSERT_TRUE(first->append(std::as_bytes(std::span("first", 5))));
  ASSERT_TRUE(first->commit_new());
  {
    Result<AtomicFile> second = AtomicFile::create(target);
    EXPECT_FALSE(second->commit_new());
  }
  EXPECT_EQ(content(target), "first");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, WhatAKilledProcessLeavesIsRemovedAndFilesThatAreBeingWrittenStay) {
  const auto killed = [this] {
    const Result<AtomicFile> file = AtomicFile::create(folder_ / "abandoned");
    std::raise(SIGKILL);
  };
  EXPECT_EXIT(killed(), ::testing::KilledBySignal(SIGKILL), "");
  ASSERT_TRUE(write_file_atomically(folder_ / "other.tmp-1", "stays"));
  Result<AtomicFile> written = AtomicFile::create(folder_ / "written");
  EXPECT_EQ(entries(), 3u);
  remove_abandoned_files(folder_);
  EXPECT_EQ(entries(), 2u);
  ASSERT_TRUE(written->commit());
  EXPECT_EQ(content(folder_ / "other.tmp-1"), "stays");
  EXPECT_TRUE(fs::exists(folder_ / "written"));
}

TEST_F(AtomicFileTest, MissingFolderIsAnErrorThatNamesTheFile) {
  const Status status = write_file_atomically(folder_ / "absent" / "out", "text");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kIo);
  EXPECT_NE(status.error().message.find("absent/out"), std::string::npos);
}

}  // namespace
}  // namespace surfcast
