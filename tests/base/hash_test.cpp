#include "base/hash.h"

#include <atomic>
#include <optional>
#include <span>
#include <string>

#include <gtest/gtest.h>

namespace surfcast {
namespace {

TEST(Hash, IsXxh3) {
  EXPECT_EQ(hash_of({}), 0x2d06800538d394c2U);
  EXPECT_EQ(hash_name({}), "99aa06d3014798d86001c324468d497f");
}

TEST(Hash, DependsOnTheBytesAndTheSeed) {
  const std::string text = "some bytes";
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  EXPECT_EQ(hash_of(bytes), hash_of(bytes, 0));
  EXPECT_NE(hash_of(bytes), hash_of(bytes, 1));
  EXPECT_NE(hash_of(bytes), hash_of(bytes.first(bytes.size() - 1)));
  EXPECT_NE(hash_name(bytes), hash_name(bytes.subspan(1)));
}

TEST(Hash, InPiecesIsThatOfTheWholeUnlessItIsCancelled) {
  const std::string text(50'000'000, 'x');  // several pieces
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  std::atomic<bool> cancelled{false};
  EXPECT_EQ(hash_name(bytes, cancelled), hash_name(bytes));
  cancelled = true;
  EXPECT_EQ(hash_name(bytes, cancelled), std::nullopt);
}

}  // namespace
}  // namespace surfcast
