#include "client/chunk_table_place.h"

#include <cstdint>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

namespace surfcast::client {
namespace {

constexpr size_t kPoints = 300;

void set(std::string& file, size_t offset, uint64_t value, size_t size) {
  std::memcpy(file.data() + offset, &value, size);
}

/// A LAZ file of 500 bytes, with the chunk table at 400; what stands before its points is not read.
std::string laz(uint64_t stated, uint64_t at_end = 400, uint8_t format = 0x83) {
  std::string file(500, '\x7e');
  file.replace(0, 4, "LASF");
  set(file, 96, kPoints, 4);
  set(file, 104, format, 1);
  set(file, kPoints, stated, 8);
  set(file, file.size() - 8, at_end, 8);
  return file;
}

std::optional<ChunkTablePlace::Correction> correction_of(const std::string& file, size_t piece = 1000) {
  ChunkTablePlace place;
  for (size_t at = 0; at < file.size(); at += piece) place.add(std::string_view(file).substr(at, piece));
  return place.correction();
}

TEST(ChunkTablePlace, IsThatOfTheEndHoweverTheFileArrives) {
  const std::string file = laz(UINT64_MAX);
  for (const size_t piece : {1, 3, 8, 97, 301, 499, 1000}) {
    const auto correction = correction_of(file, piece);
    ASSERT_TRUE(correction) << piece;
    EXPECT_EQ(correction->offset, kPoints);
    std::string corrected = file;
    corrected.replace(correction->offset, correction->bytes.size(), correction->bytes);
    EXPECT_EQ(corrected, laz(400)) << piece;
  }
}

TEST(ChunkTablePlace, StaysWhereItIsKnownOrMakesNoSense) {
  EXPECT_FALSE(correction_of(laz(400)));
  EXPECT_FALSE(correction_of(laz(UINT64_MAX, 100))) << "before the points";
  EXPECT_FALSE(correction_of(laz(UINT64_MAX, 4000))) << "beyond the end";
  EXPECT_FALSE(correction_of(laz(UINT64_MAX, 400, 0x03))) << "LAS";
  EXPECT_FALSE(correction_of("ply\n"));
  EXPECT_FALSE(correction_of(""));
  EXPECT_FALSE(correction_of(laz(UINT64_MAX).substr(0, 305)));
}

}  // namespace
}  // namespace surfcast::client
