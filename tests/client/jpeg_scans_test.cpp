#include "client/jpeg_scans.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "client/jpeg_file.h"

namespace surfcast::client {
namespace {

using picture::JpegOrder;

TEST(JpegScans, GrowWithTheFileAndLieWithinIt) {
  const std::string file = jpeg_file(JpegOrder::kScans);
  std::set<size_t> found;
  size_t before = 0;
  for (size_t length = 0; length <= file.size(); ++length) {
    const size_t shown = showable_bytes(std::string_view(file).substr(0, length));
    EXPECT_GE(shown, before);
    EXPECT_LE(shown, length);
    before = shown;
    found.insert(shown);
  }
  EXPECT_EQ(before, file.size() - kEndOfJpeg.size());
  EXPECT_GE(found.size(), 5U) << "nothing, and after several scans";
  EXPECT_GT(*std::next(found.begin()), file.size() / 5) << "the first scans are too coarse";
  EXPECT_LT(*std::next(found.begin()), file.size() * 2 / 3);
}

TEST(JpegScans, EndWhereAMarkerFollows) {
  const std::string file = jpeg_file(JpegOrder::kScans);
  for (size_t length = 0; length <= file.size(); ++length) {
    const size_t shown = showable_bytes(std::string_view(file).substr(0, length));
    if (shown == 0) continue;
    EXPECT_EQ(file[shown], '\xff');
    EXPECT_NE(file[shown + 1], '\0');
  }
}

TEST(JpegScans, AreNotLookedForInFilesWithRowsInOrder) {
  EXPECT_EQ(showable_bytes(jpeg_file(JpegOrder::kRows)), 0U);
}

TEST(JpegScans, AreNoneInOtherBytes) {
  for (const std::string& bytes :
       {std::string(), std::string("\xff"), std::string("\xff\xd8"), std::string("\x89PNG\r\n"),
        std::string("\xff\xd8\xff\xc2\x00\x01", 6), std::string(64, '\xff')}) {
    EXPECT_EQ(showable_bytes(bytes), 0U);
  }
}

TEST(JpegScans, OfADamagedFileLieWithinIt) {
  const std::string file = jpeg_file(JpegOrder::kScans);
  for (size_t at = 0; at < file.size(); ++at) {
    for (const char value : {'\0', '\xff', '\xda'}) {
      std::string damaged = file;
      damaged[at] = value;
      EXPECT_LE(showable_bytes(damaged), damaged.size());
    }
  }
}

}  // namespace
}  // namespace surfcast::client
