#include "model/georeference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::model {
namespace {

const Georeference kSomewhere{{"ETRS89 / UTM zone 32N", "EPSG:25832", "PROJCRS[...]"},
                              {"ETRS89", "EPSG:4258", "GEOGCRS[...]"}};

TEST(Georeference, ComesBackFromItsBytes) {
  for (const Georeference& georeference : {kSomewhere, Georeference{kSomewhere.system, {}}}) {
    const auto read = read_georeference(write_georeference(georeference));
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, georeference);
  }
}

TEST(Georeference, DamagedBytesAreRefused) {
  const std::vector<std::byte> whole = write_georeference(kSomewhere);
  for (size_t i = 0; i < whole.size(); ++i) {
    std::vector<std::byte> damaged = whole;
    damaged[i] ^= std::byte{1};
    const auto read = read_georeference(damaged);
    ASSERT_FALSE(read) << i;
    EXPECT_THAT(read.error().message, ::testing::HasSubstr("coordinate system"));
  }
}

TEST(Georeference, PartsOfTheBytesAreRefused) {
  const std::vector<std::byte> whole = write_georeference(kSomewhere);
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(read_georeference(std::span(whole).first(length))) << length;
  }
}

TEST(Georeference, OfAFileThatIsNotThereFails) {
  const auto read = load_georeference("/nonexistent/model.surf");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, ::testing::HasSubstr("/nonexistent/model.surf"));
}

}  // namespace
}  // namespace surfcast::model
