#include "colorize/geo_photo.h"

#include <cstring>
#include <span>
#include <string>

#include <gtest/gtest.h>

namespace surfcast::colorize {
namespace {

void expect_near(const glm::dvec2& a, const glm::dvec2& b) {
  EXPECT_NEAR(a.x, b.x, 1e-9);
  EXPECT_NEAR(a.y, b.y, 1e-9);
}

TEST(GeoPhoto, AWorldFileStatesTheCentreOfTheFirstPixel) {
  const Result<PhotoFrame> frame = parse_world_file("0.5\n0\n0\n-0.5\n500000.25\n4000000.75\n");
  ASSERT_TRUE(frame) << frame.error().message;
  expect_near(frame->pixel_of({500000.25, 4000000.75}), {0.5, 0.5});
  expect_near(frame->pixel_of({500001, 4000000}), {2, 2});
  EXPECT_NEAR(frame->pixel_side(), 0.5, 1e-12);
}

TEST(GeoPhoto, AWorldFileMayTurnThePicture) {
  const Result<PhotoFrame> frame = parse_world_file("0 1 1 0 10 20");  // rows go north, columns east
  ASSERT_TRUE(frame);
  expect_near(frame->pixel_of({10, 22}), {2.5, 0.5});
}

TEST(GeoPhoto, DamagedWorldFilesAreErrors) {
  EXPECT_FALSE(parse_world_file("0.5 0 0 -0.5 1"));
  EXPECT_FALSE(parse_world_file("0 0 0 0 1 1"));
  EXPECT_FALSE(parse_world_file("nan 0 0 1 1 1"));
}

/// A TIFF file with nothing but tags; values of more than four bytes follow the directory.
class TagFile {
 public:
  template <typename T>
  void add(uint16_t tag, uint16_t type, const std::vector<T>& values) {
    const auto offset = static_cast<uint32_t>(values_.size());
    values_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    entries_.push_back({tag, type, static_cast<uint32_t>(values.size()), offset});
  }
  [[nodiscard]] std::string bytes() const {
    std::string file("II\x2A\0\x8\0\0\0", 8);
    const auto put = [&file](const auto& value) { file.append(reinterpret_cast<const char*>(&value), sizeof value); };
    put(static_cast<uint16_t>(entries_.size()));
    const auto first = static_cast<uint32_t>(8 + 2 + 12 * entries_.size() + 4);
    for (const Entry& entry : entries_) {
      put(entry.tag);
      put(entry.type);
      put(entry.count);
      put(first + entry.offset);
    }
    put(uint32_t{0});
    return file + values_;
  }

 private:
  struct Entry {
    uint16_t tag;
    uint16_t type;
    uint32_t count;
    uint32_t offset;
  };
  std::vector<Entry> entries_;
  std::string values_;
};

Result<PhotoFrame> frame_of(const std::string& bytes) {
  return parse_geotiff(std::as_bytes(std::span(bytes)));
}

TEST(GeoPhoto, TagsOfGeotiffStateACornerOrACentre) {
  TagFile file;
  file.add<double>(33550, 12, {0.25, 0.25, 0});
  file.add<double>(33922, 12, {0, 0, 0, 1000, 2000, 0});
  const Result<PhotoFrame> corner = frame_of(file.bytes());
  ASSERT_TRUE(corner) << corner.error().message;
  expect_near(corner->pixel_of({1001, 1999}), {4, 4});
  file.add<uint16_t>(34735, 3, {1, 1, 0, 1, 1025, 0, 1, 2});
  const Result<PhotoFrame> centre = frame_of(file.bytes());
  ASSERT_TRUE(centre);
  expect_near(centre->pixel_of({1001, 1999}), {4.5, 4.5});
}

TEST(GeoPhoto, AMatrixOfGeotiffIsRead) {
  TagFile file;
  file.add<double>(34264, 12, {0, 2, 0, 100, -2, 0, 0, 200, 0, 0, 0, 0, 0, 0, 0, 1});
  const Result<PhotoFrame> frame = frame_of(file.bytes());
  ASSERT_TRUE(frame) << frame.error().message;
  expect_near(frame->pixel_of({100 + 2 * 3, 200 - 2 * 5}), {5, 3});
}

TEST(GeoPhoto, EveryTruncatedFileIsAnErrorOrRead) {
  TagFile file;
  file.add<double>(33550, 12, {0.25, 0.25, 0});
  file.add<double>(33922, 12, {0, 0, 0, 1000, 2000, 0});
  const std::string whole = file.bytes();
  for (size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(frame_of(whole.substr(0, size)));
}

}  // namespace
}  // namespace surfcast::colorize
