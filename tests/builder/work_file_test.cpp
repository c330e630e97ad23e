#include "builder/work_file.h"

#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/test_folder.h"
#include "support/file_content.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string kDigest(32, 'a');

std::vector<std::byte> counting_bytes(size_t size) {
  std::vector<std::byte> bytes(size);
  for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 31 % 251);
  return bytes;
}

/// Bytes that cannot be compressed.
std::vector<std::byte> random_bytes(size_t size) {
  std::mt19937 random(7);
  std::vector<std::byte> bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

void put_content(const fs::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

class WorkFileTest : public ::testing::Test {
 protected:
  void write(const std::vector<std::vector<std::byte>>& sections) const {
    Result<WorkFileWriter> writer = WorkFileWriter::create(path_, owner_);
    ASSERT_TRUE(writer) << writer.error().message;
    for (const std::vector<std::byte>& section : sections) ASSERT_TRUE(writer->add(section));
    ASSERT_TRUE(writer->finish());
  }
  [[nodiscard]] bool is_whole() const {
    const Result<WorkFile> file = WorkFile::open(path_, owner_);
    return file && file->check().has_value();
  }

  model::TestFolder folder_;
  fs::path path_ = folder_ / "part-3";
  WorkOwner owner_{kDigest, WorkStep::kPart, 3};
};

TEST_F(WorkFileTest, SectionsOfAnySizeComeBack) {
  // Empty, small, exactly one piece, and several; that can be compressed, and that cannot.
  const std::vector<std::vector<std::byte>> sections{{},
                                                     counting_bytes(5),
                                                     counting_bytes(1 << 20),
                                                     random_bytes(1 << 20),
                                                     counting_bytes((5 << 19) + 7),
                                                     random_bytes((5 << 19) + 7)};
  write(sections);
  const Result<WorkFile> file = WorkFile::open(path_, owner_);
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->sections(), sections.size());
  for (size_t i = 0; i < sections.size(); ++i) {
    const Result<std::vector<std::byte>> section = file->read(i);
    ASSERT_TRUE(section) << i;
    EXPECT_TRUE(*section == sections[i]) << i;
  }
  EXPECT_TRUE(file->check());
}

TEST_F(WorkFileTest, SectionsAreCompressedWhereThatMakesThemSmaller) {
  write({counting_bytes(3 << 20)});
  EXPECT_LT(fs::file_size(path_), 3 << 15);
  write({random_bytes(3 << 20)});
  EXPECT_LT(fs::file_size(path_), (3 << 20) + 200);
}

TEST_F(WorkFileTest, EveryChangedByteIsNoticed) {
  write({counting_bytes(1000), random_bytes(40), counting_bytes(3)});
  const std::string whole = testing::file_content(path_);
  ASSERT_TRUE(is_whole());
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 4);
    put_content(path_, changed);
    EXPECT_FALSE(is_whole()) << i;
  }
}

TEST_F(WorkFileTest, EveryLengthButItsOwnIsNoticed) {
  write({counting_bytes(1000), random_bytes(40), counting_bytes(3)});
  const std::string whole = testing::file_content(path_);
  for (size_t size = 0; size < whole.size(); ++size) {
    put_content(path_, whole.substr(0, size));
    EXPECT_FALSE(is_whole()) << size;
  }
  put_content(path_, whole + '\0');
  EXPECT_FALSE(is_whole());
}

TEST_F(WorkFileTest, DamageOfASectionIsAnErrorOfThatSection) {
  write({random_bytes(3 << 20), counting_bytes(9)});
  std::string changed = testing::file_content(path_);
  changed[(2 << 20) + 5] ^= 1;
  put_content(path_, changed);
  const Result<WorkFile> file = WorkFile::open(path_, owner_);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->read(0).error().kind, ErrorKind::kInvalidInput);
  EXPECT_THAT(file->read(0).error().message, HasSubstr("part-3: is damaged"));
  EXPECT_TRUE(file->read(1));
}

TEST_F(WorkFileTest, WhoseWorkItIsIsCompared) {
  write({counting_bytes(9)});
  const WorkOwner others[] = {
      {std::string(32, 'b'), WorkStep::kPart, 3}, {kDigest, WorkStep::kBlocks, 3}, {kDigest, WorkStep::kPart, 4}};
  for (const WorkOwner& other : others) {
    EXPECT_EQ(WorkFile::open(path_, other).error().kind, ErrorKind::kReplaced);
  }
  EXPECT_EQ(WorkFile::open(folder_ / "part-4", owner_).error().kind, ErrorKind::kNotFound);
}

TEST_F(WorkFileTest, AnUnfinishedFileIsNotThere) {
  {
    Result<WorkFileWriter> writer = WorkFileWriter::create(path_, owner_);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->add(counting_bytes(9)));
  }
  EXPECT_FALSE(fs::exists(path_));
}

}  // namespace
}  // namespace surfcast::builder
