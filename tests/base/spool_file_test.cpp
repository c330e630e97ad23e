#include "base/spool_file.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/test_folder.h"

namespace surfcast {
namespace {

std::vector<std::byte> numbers(size_t count, int first) {
  std::vector<std::byte> bytes(count);
  for (size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::byte>(first + static_cast<int>(i));
  return bytes;
}

TEST(SpoolFileTest, GivesBackWhatWasAppended) {
  const model::TestFolder folder;
  Result<SpoolFile> file = SpoolFile::create(folder / "model.surf");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(*file->append(numbers(1000, 1)), 0U);
  EXPECT_EQ(*file->append(numbers(500, 7)), 1000U);
  EXPECT_EQ(file->size(), 1500U);
  std::vector<std::byte> back(500);
  ASSERT_TRUE(file->read(1000, back));
  EXPECT_EQ(back, numbers(500, 7));
}

TEST(SpoolFileTest, HasNoNameInTheFolder) {
  const model::TestFolder folder;
  Result<SpoolFile> file = SpoolFile::create(folder / "model.surf");
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append(numbers(10, 0)));
  EXPECT_TRUE(folder.empty());
}

TEST(SpoolFileTest, KeepsOtherBytesWhenSomeAreReleased) {
  const model::TestFolder folder;
  Result<SpoolFile> file = SpoolFile::create(folder / "model.surf");
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append(numbers(100000, 0)));
  ASSERT_TRUE(file->append(numbers(10, 3)));
  file->release(0, 100000);
  std::vector<std::byte> back(10);
  ASSERT_TRUE(file->read(100000, back));
  EXPECT_EQ(back, numbers(10, 3));
}

TEST(SpoolFileTest, FailuresNameTheTarget) {
  const model::TestFolder folder;
  const Result<SpoolFile> file = SpoolFile::create((folder / "absent") / "model.surf");
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message, ::testing::HasSubstr("model.surf: "));
  Result<SpoolFile> small = SpoolFile::create(folder / "model.surf");
  ASSERT_TRUE(small);
  std::vector<std::byte> beyond(10);
  EXPECT_FALSE(small->read(0, beyond));
}

}  // namespace
}  // namespace surfcast
